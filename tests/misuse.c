/* Calls the C interface wrongly in each way that it can tell, and checks what it is told. */
#include "planner.h"

#include <stdio.h>
#include <string.h>

static uint64_t memory[4096];

#define IS(call, expected) \
    do { \
        int got = (int)(call); \
        if (got != (int)(expected)) { \
            fprintf(stderr, "%s: %d\n", #call, got); \
            failed = 1; \
        } \
    } while (0)

int main(void) {
    int failed = 0;
    const planner_mission good = {
        .max_x = 20.0, .max_z = 20.0, .p = 1.0, .sharpest = 1.57, .turn_step_urad = 10000, .step_mm = 50, .steps = 20,
    };
    const planner_sample given[] = {
        {2.0, 1.0, false}, {2.0, 8.0, true}, {18.0, 16.0, true}, {18.0, 5.0, false},
    };
    const planner_sample inseparable[] = {{0.0, 0.0, true}, {1.0, 0.0, false}, {2.0, 0.0, true}, {1.0, 1.0, true}};
    planner_t *planner = NULL;
    uint8_t *at = (uint8_t *)memory;
    size_t size = sizeof memory;

    IS(planner_begin(NULL, at, size, &good, given, 4), PLANNER_STATUS_MEMORY);
    IS(planner_begin(&planner, NULL, size, &good, given, 4), PLANNER_STATUS_MEMORY);
    IS(planner_begin(&planner, at + 1, size - 1, &good, given, 4), PLANNER_STATUS_MEMORY);
    IS(planner_begin(&planner, at, planner_bytes(&good) - 1, &good, given, 4), PLANNER_STATUS_MEMORY);
    IS(planner_begin(&planner, at, size, NULL, given, 4), PLANNER_STATUS_MEMORY);
    IS(planner_begin(&planner, at, size, &good, NULL, 4), PLANNER_STATUS_MEMORY);
    IS(planner_begin(&planner, at, size, &good, given, 17), PLANNER_STATUS_GIVEN);
    IS(planner_begin(&planner, at, size, &good, given, 0), PLANNER_STATUS_GIVEN);
    IS(planner_begin(&planner, at, size, &good, inseparable, 4), PLANNER_STATUS_GIVEN);
    planner_mission bad = good;
    bad.p = 0.5;
    IS(planner_begin(&planner, at, size, &bad, given, 4), PLANNER_STATUS_MISSION);
    IS(planner_bytes(&bad), 0);
    IS(planner_bytes(NULL), 0);
    bad = good, bad.tolerance = -1.0;
    IS(planner_begin(&planner, at, size, &bad, given, 4), PLANNER_STATUS_MISSION);
    bad = good, bad.max_x = 0.0;
    IS(planner_begin(&planner, at, size, &bad, given, 4), PLANNER_STATUS_MISSION);
    bad = good, bad.max_x = 1e9;
    IS(planner_begin(&planner, at, size, &bad, given, 4), PLANNER_STATUS_POSITION);
    bad = good, bad.steps = 65535;
    IS(planner_begin(&planner, at, size, &bad, given, 4), PLANNER_STATUS_MISSION);
    bad = good, bad.slopes = 2.0;
    IS(planner_begin(&planner, at, size, &bad, given, 4), PLANNER_STATUS_MISSION);
    IS(planner != NULL, 0);

    IS(planner_begin(&planner, at, planner_bytes(&good), &good, given, 4), PLANNER_STATUS_OK);
    planner_pose pose = {2.0, 1.0, 0.0}, nowhere = {0.0 / 0.0, 0.0, 0.0};
    planner_motion motion;
    planner_line line;
    IS(planner_plan(NULL, pose, &motion), PLANNER_STATUS_MEMORY);
    IS(planner_plan(planner, pose, NULL), PLANNER_STATUS_MEMORY);
    IS(planner_plan(planner, nowhere, &motion), PLANNER_STATUS_POSITION);
    IS(planner_observe(NULL, pose, PLANNER_READING_POSITIVE), PLANNER_STATUS_MEMORY);
    IS(planner_observe(planner, nowhere, PLANNER_READING_POSITIVE), PLANNER_STATUS_POSITION);
    IS(planner_observe(planner, pose, 7), PLANNER_STATUS_READING);
    IS(planner_observe(planner, pose, PLANNER_READING_POSITIVE), PLANNER_STATUS_CONTRADICTION);
    IS(planner_estimate(planner, NULL), PLANNER_STATUS_MEMORY);
    IS(planner_estimate(NULL, &line), PLANNER_STATUS_MEMORY);
    IS(planner_bits(NULL) == planner_bits(NULL), 0);
    /* What was refused left it as it was. */
    IS(planner_plan(planner, pose, &motion), PLANNER_STATUS_OK);
    IS(planner_observe(planner, motion.target, PLANNER_READING_BOUNDARY), PLANNER_STATUS_OK);
    IS(planner_estimate(planner, &line), PLANNER_STATUS_OK);

    /* Whether a sample is positive is a byte, and may be any byte of the caller's memory. */
    planner_t *running = planner;
    double bits = planner_bits(planner);
    planner_mission doubtful = good;
    doubtful.p = 0.85;
    for (int byte = 2; byte < 256; byte++) {
        planner_sample garbled[4];
        memcpy(garbled, given, sizeof garbled);
        memset(&garbled[byte % 4].is_positive, byte, 1);
        IS(planner_begin(&planner, at, size, &good, garbled, 4), PLANNER_STATUS_GIVEN);
        IS(planner_begin(&planner, at, size, &doubtful, garbled, 4), PLANNER_STATUS_GIVEN);
    }
    /* A planner that cannot begin leaves the one that is in that memory as it was. */
    const planner_sample one_label[] = {{2.0, 1.0, true}, {2.0, 8.0, true}, {18.0, 16.0, true}};
    const planner_mission *missions[] = {&good, &doubtful};
    for (int kind = 0; kind < 4; kind++) {
        if (kind == 2) {
            IS(planner_begin(&running, at, size, &doubtful, given, 4), PLANNER_STATUS_OK);
            planner = running;
            IS(planner_observe(planner, motion.target, PLANNER_READING_POSITIVE), PLANNER_STATUS_OK);
            bits = planner_bits(planner);
        }
        const planner_mission *mission = missions[kind % 2];
        IS(planner_begin(&planner, at, size, mission, inseparable, 4), PLANNER_STATUS_GIVEN);
        IS(planner_begin(&planner, at, size, mission, one_label, 3), PLANNER_STATUS_GIVEN);
        IS(planner_begin(&planner, at, size, mission, given, 2), PLANNER_STATUS_GIVEN);
        IS(planner_begin(&planner, at, planner_bytes(mission) - 1, mission, given, 4), PLANNER_STATUS_MEMORY);
        IS(planner == running, 1);
        IS(planner_bits(planner) == bits, 1);
        IS(planner_plan(planner, pose, &motion), PLANNER_STATUS_OK);
    }

    /* A tolerance that leaves nothing of the area, and one that leaves no label that tells more. */
    planner_mission vague = good;
    vague.tolerance = 10.0;
    IS(planner_begin(&planner, at, size, &vague, given, 4), PLANNER_STATUS_TOLERANCE_TOO_LARGE);
    vague.tolerance = 2.0;
    const planner_sample narrow[] = {{2.0, 9.0, false}, {2.0, 11.0, true}, {18.0, 11.0, true}, {18.0, 9.0, false}};
    const planner_pose middle = {10.0, 10.0, 0.0};
    IS(planner_begin(&planner, at, size, &vague, narrow, 4), PLANNER_STATUS_OK);
    IS(planner_plan(planner, middle, &motion), PLANNER_STATUS_IMPRECISE);
    return failed;
}
