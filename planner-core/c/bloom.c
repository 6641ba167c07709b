/* A robot finds an algal bloom, goes round it, and prints its map, from C. One label in twenty is wrong.
 *
 *     cargo build -p planner-c --release
 *     cc -Iplanner-core/c/include planner-core/c/bloom.c target/release/libplanner_c.a -lm -lpthread -ldl -o bloom
 */
#include "planner.h"

#include <stdio.h>

/* Your memory: nothing is allocated. */
static uint64_t memory[PLANNER_FOLLOWER_BYTES / sizeof(uint64_t)];

/* Your sensor. The bloom is a disc, which the planner does not know. */
static int32_t read_label(planner_pose at, unsigned count) {
    double x = at.x - 120.0, z = at.z - 90.0;
    bool inside = x * x + z * z < 25.0 * 25.0;
    bool wrong = count % 20 == 7;
    return inside != wrong ? PLANNER_READING_POSITIVE : PLANNER_READING_NEGATIVE;
}

int main(void) {
    const planner_mission mission = {
        .min_x = 0.0, .min_z = 0.0, .max_x = 200.0, .max_z = 150.0,
        .p = 0.95,
        .sharpest = 1.57, .turn_step_urad = 10000,
        .step_mm = 100, .steps = 30, /* motions of up to 3 m */
    };
    const planner_front_settings still = {.radius = 1.0, .speed = 0.0, .until_closed = true};
    planner_pose pose = {10.0, 10.0, 0.0};
    planner_front_place front;
    planner_follower_t *follower = NULL;
    unsigned labels = 0, places = 0;
    planner_status status = planner_follow(&follower, memory, sizeof memory, &mission, still, NULL, 0);
    for (int step = 0; step < 1000 && status == PLANNER_STATUS_OK; step++) {
        planner_motion motion;
        status = planner_follower_plan(follower, pose, &motion);
        if (status != PLANNER_STATUS_OK) break;
        pose = motion.target; /* your drive: where it truly ended */
        int32_t reading = motion.wants_label ? read_label(pose, ++labels) : PLANNER_READING_NONE;
        status = planner_follower_observe(follower, pose, reading);
        if (status == PLANNER_STATUS_OK && planner_front(follower, &front) == PLANNER_STATUS_OK) {
            places++; /* the front beside the robot; within 1.645 deviations with probability 0.9 */
            printf("%.2f,%.2f within %.2f m\n", front.pose.x, front.pose.z, 1.645 * front.deviation);
        }
    }
    if (status != PLANNER_STATUS_CLOSED) {
        fprintf(stderr, "ended with status %d\n", (int)status);
        return 1;
    }
    printf("%u places, %u labels\n", places, labels);
    return 0;
}
