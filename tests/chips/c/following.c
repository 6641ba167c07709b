/* Goes along a circle whose labels are sometimes wrong, or with `watch` stays with 20 m of it. In the middle it sleeps,
   and its memory is lost. */

#include <stdio.h>
#include <string.h>

#include "planner.h"

static uint64_t memory[1250];
static uint8_t kept[8800];

static void print(double number) {
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    printf("%08lx%08lx ", (unsigned long)(bits >> 32), (unsigned long)(bits & 0xffffffffu));
}

static planner_follower_t *begin(bool watches) {
    const planner_mission mission = {
        .max_x = 120.0, .max_z = 120.0, .p = 0.9, .sharpest = 1.57, .turn_step_urad = 10000,
        .step_mm = 100, .steps = 20,
    };
    const planner_front_settings front = {30.0, 0.01};
    const planner_sample given[] = {{60.0, 10.0, false}, {60.0, 50.0, true}};
    planner_follower_t *follower = NULL;
    if (planner_follower_bytes() > sizeof memory) return NULL;
    if (watches) {
        if (planner_watch(&follower, memory, sizeof memory, &mission, front, 0.09, given, 2) != PLANNER_STATUS_MISSION)
            return NULL;
        if (planner_watch(&follower, memory, sizeof memory, &mission, front, 20.0, given, 2)) return NULL;
    } else if (planner_follow(&follower, memory, sizeof memory, &mission, front, given, 2)) {
        return NULL;
    }
    return follower;
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
            size_t count = planner_follower_save(follower, kept, sizeof kept);
            // Without room for all of it, what was kept stays as it was.
            if (!count || planner_follower_save(follower, kept, count - 1)) return 2;
            memset(memory, 0xa5, sizeof memory);
            follower = begin(watches);
            kept[100] ^= 1;
            if (planner_follower_restore(follower, kept, count) != PLANNER_STATUS_SNAPSHOT_SPOILT) return 3;
            kept[100] ^= 1;
            if (planner_follower_restore(follower, kept, count)) return 4;
        }
        if (planner_follower_plan(follower, pose, &motion)) return 5;
        pose = motion.target;
        if (motion.wants_label) {
            double x = pose.x - 60.0, z = pose.z - 60.0;
            bool is_wrong = ++labels % 11 == 3, is_inside = x * x + z * z < 900.0;
            reading = is_inside == is_wrong ? PLANNER_READING_NEGATIVE : PLANNER_READING_POSITIVE;
        }
        if (planner_follower_observe(follower, pose, reading)) return 6;
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
        } else if (planner_front_beside(follower, pose, &crossing) != PLANNER_STATUS_UNDECIDED) {
            return 8;
        }
        printf("\n");
    }
    return 0;
}
