/* The planner from C: look for z = 0.41 x + 3.5 in a field of 20 m x 20 m, with labels that are always right, or,
 * with the argument "doubtful", wrong every seventh time.
 *
 *     cargo build -p planner-c --release
 *     cc -Iplanner-core/c/include planner-core/c/example.c target/release/libplanner_c.a -lm -lpthread -ldl -o example
 */
#include "planner.h"

#include <stdio.h>
#include <string.h>

/* Your memory: nothing is allocated. PLANNER_BYTES are enough for labels that are always right. */
static uint64_t memory[PLANNER_DOUBTFUL_BYTES / sizeof(uint64_t)];

/* Your sensor. */
static int32_t read_label(planner_pose at, unsigned count, bool doubtful) {
    bool above = at.z > 0.41 * at.x + 3.5;
    bool wrong = doubtful && count % 7 == 3;
    return above != wrong ? PLANNER_READING_POSITIVE : PLANNER_READING_NEGATIVE;
}

int main(int argc, char **argv) {
    bool doubtful = argc > 1 && strcmp(argv[1], "doubtful") == 0;
    const planner_mission mission = {
        .min_x = 0.0, .min_z = 0.0, .max_x = 20.0, .max_z = 20.0,
        .tolerance = 0.0,
        .p = doubtful ? 0.85 : 1.0,
        .slopes = doubtful ? 0.21 : 0.0035, /* 12 degrees, 0.2 degrees */
        .sharpest = 1.57, .turn_step_urad = 10000,
        .step_mm = 50, .steps = 20,
    };
    const planner_sample given[] = {
        {2.0, 1.0, false}, {2.0, 8.0, true}, {18.0, 16.0, true}, {18.0, 5.0, false},
    };
    planner_pose pose = {2.0, 1.0, 0.0};
    planner_t *planner = NULL;
    planner_status status = planner_begin(&planner, memory, sizeof memory, &mission, given, 4);
    unsigned labels = 0;
    while (status == PLANNER_STATUS_OK) {
        planner_motion motion;
        status = planner_plan(planner, pose, &motion);
        if (status != PLANNER_STATUS_OK) break;
        pose = motion.target; /* your drive: where it truly ended */
        int32_t reading = motion.wants_label ? read_label(pose, ++labels, doubtful) : PLANNER_READING_NONE;
        printf("%.9f %.9f %.9f %d\n", pose.x, pose.z, pose.heading, (int)reading);
        status = planner_observe(planner, pose, reading);
    }
    planner_line line;
    if (status != PLANNER_STATUS_KNOWN || planner_estimate(planner, &line) != PLANNER_STATUS_OK) {
        fprintf(stderr, "ended with status %d\n", (int)status);
        return 1;
    }
    printf("line %.9f %.9f %.9f, %.6f bits, %zu bytes\n", line.a, line.b, line.c, planner_bits(planner),
           planner_bytes(&mission));
    return 0;
}
