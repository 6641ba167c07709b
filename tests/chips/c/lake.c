/* A lake with an island and a keep-out, as a chart: look-ahead with true labels or, with the argument "doubtful", with some
 * that are wrong; with "front", along the edge of a spill. No motion ends on land.
 */
#include "planner.h"

#include <stdio.h>
#include <string.h>

#define COLUMNS 40
#define ROWS 40
#define SIDE 0.5

static uint32_t cells[PLANNER_CHART_WORDS(COLUMNS, ROWS)];
static uint64_t memory[PLANNER_DOUBTFUL_BYTES / sizeof(uint64_t)];

/* Water but for an island and two corners. */
static bool is_water(int column, int row) {
    bool is_island = column >= 16 && column < 24 && row >= 14 && row < 22;
    return !is_island && column + row > 2 && column + row < 70;
}

/* Prints where a motion ended and what was read there. Returns whether that is on the water. */
static bool prints(planner_pose pose, int32_t reading) {
    printf("%.9f %.9f %.9f %d\n", pose.x, pose.z, pose.heading, (int)reading);
    return is_water((int)(pose.x / SIDE), (int)(pose.z / SIDE));
}

static int32_t sign(bool is_positive) {
    return is_positive ? PLANNER_READING_POSITIVE : PLANNER_READING_NEGATIVE;
}

static int along(const planner_mission *mission) {
    const planner_front_settings front = {.radius = 4.0};
    planner_follower_t *planner;
    planner_pose pose = {10.0, 3.5, 0.0};
    if (planner_follow(&planner, memory, sizeof memory, mission, front, NULL, 0) != PLANNER_STATUS_OK) return 1;
    for (int step = 0; step < 60; step++) {
        planner_motion motion;
        if (planner_follower_plan(planner, pose, &motion) != PLANNER_STATUS_OK) return 2;
        pose = motion.target;
        double x = pose.x - 10.0, z = pose.z - 9.0;
        int32_t reading = motion.wants_label ? sign(x * x + z * z < 36.0) : PLANNER_READING_NONE;
        if (!prints(pose, reading) || planner_follower_observe(planner, pose, reading) != PLANNER_STATUS_OK) return 3;
    }
    return 0;
}

int main(int argc, char **argv) {
    const bool is_front = argc > 1 && strcmp(argv[1], "front") == 0;
    const bool is_doubtful = argc > 1 && strcmp(argv[1], "doubtful") == 0;
    for (int row = 0; row < ROWS; row++) {
        for (int column = 0; column < COLUMNS; column++) {
            uint32_t bit = is_water(column, row);
            cells[PLANNER_CHART_WORDS(COLUMNS, row) + column / 32] |= bit << column % 32;
        }
    }
    const planner_chart chart = {.cells = cells, .side = SIDE, .columns = COLUMNS, .rows = ROWS};
    const planner_area buoy = {.keep_out_count = 1, .keep_outs = {{.corner_count = 1, .corners = {{5.0, 6.0}}, .radius = 1.0}}};
    const planner_mission mission = {
        .p = is_doubtful ? 0.85 : 1.0, .slopes = is_front ? 0.0 : is_doubtful ? 0.21 : 0.0035, .sharpest = 1.57,
        .turn_step_urad = 10000, .step_mm = 50, .steps = 20, .area = &buoy, .chart = &chart,
    };
    if (is_front) return along(&mission);
    const planner_sample given[] = {{2.0, 1.0, 0}, {2.0, 8.0, 1}, {18.0, 16.0, 1}, {18.0, 5.0, 0}};
    planner_pose pose = {2.0, 1.0, 0.0};
    planner_t *planner = NULL;
    planner_status status = planner_begin(&planner, memory, sizeof memory, &mission, given, 4);
    for (unsigned labels = 0; status == PLANNER_STATUS_OK;) {
        planner_motion motion;
        status = planner_plan(planner, pose, &motion);
        if (status != PLANNER_STATUS_OK) break;
        pose = motion.target;
        int32_t reading = PLANNER_READING_NONE;
        if (motion.wants_label) {
            bool is_wrong = is_doubtful && ++labels % 7 == 3;
            reading = sign((pose.z > 0.41 * pose.x + 3.5) != is_wrong);
        }
        if (!prints(pose, reading)) return 1;
        status = planner_observe(planner, pose, reading);
    }
    planner_line line;
    if (status != PLANNER_STATUS_KNOWN || planner_estimate(planner, &line) != PLANNER_STATUS_OK) {
        fprintf(stderr, "ended with status %d\n", (int)status);
        return 1;
    }
    printf("line %.9f %.9f %.9f, %.6f bits", line.a, line.b, line.c, planner_bits(planner));
    return 0;
}
