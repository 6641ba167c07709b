/* Goes along a circle whose labels are sometimes wrong, or with `watch` stays with 20 m of it, and reads labels on the way.
   In the middle it sleeps, and its memory is lost. */

#include <stdio.h>
#include <string.h>

#include "planner.h"

static uint64_t memory[PLANNER_FOLLOWER_BYTES / sizeof(uint64_t)];
static uint8_t kept[PLANNER_FOLLOWER_SNAPSHOT_BYTES];

static void print(double number) {
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    printf("%08lx%08lx ", (unsigned long)(bits >> 32), (unsigned long)(bits & 0xffffffffu));
}

static planner_follower_t *begin(bool watches) {
    const planner_mission mission = {
        .max_x = 120.0, .max_z = 120.0, .p = 0.9, .tolerance = 0.1, .sharpest = 1.57, .turn_step_urad = 10000,
        .step_mm = 100, .steps = 20,
    };
    const planner_front_settings front = {30.0, 0.01, watches ? 20.0 : 0.0, 0};
    const planner_sample given[] = {{60.0, 10.0, false}, {60.0, 50.0, true}};
    planner_follower_t *follower = NULL;
    if (planner_follow(&follower, memory, sizeof memory, &mission, front, given, 2)) return NULL;
    return follower;
}

static int32_t label(double x, double z, bool is_wrong) {
    bool is_inside = (x - 60.0) * (x - 60.0) + (z - 60.0) * (z - 60.0) < 900.0;
    return is_inside == is_wrong ? PLANNER_READING_NEGATIVE : PLANNER_READING_POSITIVE;
}

int main(int count_of_words, char **words) {
    planner_pose pose = {60.0, 28.0, 0.0};
    bool watches = count_of_words > 1 && !strcmp(words[1], "watch");
    planner_follower_t *follower = begin(watches);
    unsigned labels = 0;
    if (!follower) return 1;
    for (int step = 0; step < 130; step++) {
        planner_motion motion;
        planner_front_place front;
        planner_front_crossing crossing;
        int32_t reading = PLANNER_READING_NONE;
        if (step == 65) {
            size_t count;
            if (planner_follower_save(follower, kept, sizeof kept, &count)) return 2;
            memset(memory, 0xa5, sizeof memory);
            follower = begin(watches);
            kept[100] ^= 1;
            if (planner_follower_restore(follower, kept, count) != PLANNER_STATUS_SNAPSHOT_SPOILT) return 3;
            kept[100] ^= 1;
            if (planner_follower_restore(follower, kept, count)) return 4;
        }
        if (planner_follower_plan(follower, pose, &motion)) return 5;
        const planner_point half = {(pose.x + motion.target.x) / 2, (pose.z + motion.target.z) / 2};
        if (planner_follower_observe_on_the_way(follower, half, label(half.x, half.z, false))) return 9;
        pose = motion.target;
        if (motion.wants_label) {
            labels++;
            reading = label(pose.x, pose.z, labels % 11 == 3);
        }
        const planner_point here = {pose.x, pose.z};
        double chance;
        if (planner_follower_chance(follower, here, &chance)) return 10;
        if (planner_follower_observe_within(follower, pose, reading, 0.02 * (labels % 5 + 1))) return 6;
        print(chance);
        print(pose.x);
        print(pose.z);
        if (!planner_front(follower, &front)) {
            const double numbers[] = {
                front.pose.x, front.pose.z, front.pose.heading, front.curvature, front.deviation,
                front.turn_deviation, front.is_closed ? 1.0 : 0.0,
            };
            for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) print(numbers[k]);
            if (planner_front_beside(follower, pose, &crossing)) return 7;
            print(crossing.left);
            print(crossing.deviation);
        } else if (planner_front_beside(follower, pose, &crossing) != PLANNER_STATUS_UNKNOWN) {
            return 8;
        }
        printf("\n");
    }
    return 0;
}
