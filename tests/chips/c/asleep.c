/* Plans in a polygon among keep-outs and sleeps after each plan and each label: a planner elsewhere in memory goes on.
 * Prints every bit of what it is told, so that the test can compare it with a planner that stays awake.
 */
#include "planner.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static uint64_t beds[2][4096];
static const planner_sample given[] = {{2.0, 1.0, 0}, {2.0, 8.0, 1}, {18.0, 16.0, 1}, {18.0, 5.0, 0}};
static const planner_area area = {
    /* Clockwise: either order will do. */
    .corner_count = 5,
    .corners = {{0.0, 0.0}, {0.0, 20.0}, {8.0, 20.0}, {20.0, 17.0}, {20.0, 0.0}},
    .keep_out_count = 3,
    .keep_outs = {
        {.corner_count = 1, .corners = {{5.0, 6.0}}, .radius = 1.0},
        {.corner_count = 3, .corners = {{9.0, 7.0}, {11.0, 7.0}, {10.0, 9.0}}},
        {.corner_count = 2, .corners = {{13.0, 9.0}, {16.0, 9.5}}, .radius = 0.25},
    },
};

static void print(double number) {
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    printf("%016" PRIx64 " ", bits);
}

/* What outlives the sleep goes through bytes alone, as through flash. */
static planner_status sleep_and_wake(planner_t **planner, const planner_mission *mission, int *bed) {
    planner_snapshot saved, read;
    uint8_t flash[sizeof saved];
    planner_status status = planner_save(*planner, &saved);
    if (status != PLANNER_STATUS_OK) return status;
    memcpy(flash, &saved, sizeof flash);
    memset(beds[*bed], 0xff, sizeof beds[*bed]);
    *bed = 1 - *bed;
    status = planner_begin(planner, beds[*bed], sizeof beds[*bed], mission, given, 4);
    if (status != PLANNER_STATUS_OK) return status;
    memcpy(&read, flash, sizeof flash);
    return planner_restore(*planner, &read);
}

int main(int argc, char **argv) {
    const char *mode = argc > 1 ? argv[1] : "true";
    bool is_true = strcmp(mode, "true") == 0;
    bool is_blurred = strcmp(mode, "blurred") == 0;
    const planner_mission mission = {
        .area = &area,
        .tolerance = is_true || is_blurred ? 0.1 : 0.0,
        .p = is_true ? 1.0 : 0.85,
        .slopes = is_true ? 0.02 : 0.15,
        .level = is_true ? 0.0 : 0.6,
        .sharpest = 1.57, .turn_step_urad = 10000, .step_mm = 50, .steps = 40,
    };
    planner_pose pose = {2.0, 1.0, 0.0};
    planner_t *planner = NULL;
    int bed = 0;
    unsigned labels = 0;
    planner_status status = planner_begin(&planner, beds[bed], sizeof beds[bed], &mission, given, 4);
    for (unsigned motions = 0; status == PLANNER_STATUS_OK && motions < 80; motions++) {
        planner_motion motion;
        status = planner_plan(planner, pose, &motion);
        if (status != PLANNER_STATUS_OK) break;
        status = sleep_and_wake(&planner, &mission, &bed);
        if (status != PLANNER_STATUS_OK) break;
        if (is_true) {
            const planner_point half = {(pose.x + motion.target.x) / 2, (pose.z + motion.target.z) / 2};
            bool above = half.z > 0.41 * half.x + 3.5;
            int32_t there = above ? PLANNER_READING_POSITIVE : PLANNER_READING_NEGATIVE;
            status = planner_observe_on_the_way(planner, half, there);
            if (status != PLANNER_STATUS_OK) break;
            status = sleep_and_wake(&planner, &mission, &bed);
            if (status != PLANNER_STATUS_OK) break;
        }
        pose = motion.target;
        int32_t reading = PLANNER_READING_NONE;
        bool wrong = false;
        if (motion.wants_label) {
            labels++;
            wrong = !is_true && labels % 7 == 3;
            bool above = pose.z > 0.41 * pose.x + 3.5;
            reading = above != wrong ? PLANNER_READING_POSITIVE : PLANNER_READING_NEGATIVE;
        }
        double chance = -1.0;
        const planner_point here = {pose.x, pose.z};
        status = planner_chance(planner, here, &chance);
        if (status != PLANNER_STATUS_OK) break;
        print(pose.x), print(pose.z), print(pose.heading), print(chance);
        printf("%d\n", (int)reading);
        if (is_true || is_blurred) {
            status = planner_observe_within(planner, pose, reading, 0.02 * (labels % 5 + 1));
        } else {
            status = planner_observe_believed(planner, pose, reading, wrong ? 0.6 : 0.95);
        }
        if (status != PLANNER_STATUS_OK) break;
        status = sleep_and_wake(&planner, &mission, &bed);
    }
    planner_line line;
    if (planner_estimate(planner, &line) != PLANNER_STATUS_OK) {
        fprintf(stderr, "ended with status %d\n", (int)status);
        return 1;
    }
    print(line.a), print(line.b), print(line.c), print(planner_bits(planner));
    printf("%d", (int)status);
    return 0;
}
