/* Calls the C interface wrongly, and checks what it is told of missions, areas, labels and snapshots. */
#include "planner.h"
#include "seal.h"

#include <stdio.h>
#include <string.h>

static uint64_t memory[PLANNER_DOUBTFUL_BYTES / sizeof(uint64_t)];

#define IS(call, expected) \
    do { \
        int got = (int)(call); \
        if (got != (int)(expected)) { \
            fprintf(stderr, "%s: %d\n", #call, got); \
            failed = 1; \
        } \
    } while (0)

/* What is said of a mission, and of which of its parts. */
#define BLAMES(mission, given, count, said, part, index) \
    do { \
        planner_verdict it = planner_check(mission, given, count); \
        if (it.status != (said) || strcmp(it.what, part) != 0 || it.number != (index)) { \
            fprintf(stderr, "line %d: %d %s %d\n", __LINE__, (int)it.status, it.what, (int)it.number); \
            failed = 1; \
        } \
        planner_t *none = NULL; \
        IS(planner_begin(&none, memory, sizeof memory, mission, given, count), said); \
    } while (0)

/* Charts: in the place of the rectangle, with keep-outs and without. */
static int charts(const planner_mission *good, const planner_sample *given) {
    int failed = 0;
    static uint32_t cells[PLANNER_CHART_WORDS(PLANNER_CHART_CELLS, PLANNER_CHART_CELLS) + 1];
    const planner_chart all = {.cells = cells, .side = 0.5, .columns = 40, .rows = 40};
    planner_chart chart = all;
    planner_mission lake = *good;
    lake.chart = &chart;
    BLAMES(&lake, given, 4, PLANNER_STATUS_CHART, "chart", -1);
    lake.max_x = lake.max_z = 0.0;
    BLAMES(&lake, given, 4, PLANNER_STATUS_OK, "", -1);
    chart.cells = NULL;
    BLAMES(&lake, given, 4, PLANNER_STATUS_MEMORY, "chart", -1);
    chart.cells = (const uint32_t *)((uintptr_t)cells + 2);
    BLAMES(&lake, given, 4, PLANNER_STATUS_MEMORY, "chart", -1);
    const uint16_t counts[] = {0, 1, 40, 256, 257, 65535};
    for (int i = 0; i < 36; i++) {
        chart = all, chart.columns = counts[i % 6], chart.rows = counts[i / 6];
        bool is_possible = i % 6 > 0 && i % 6 < 4 && i / 6 > 0 && i / 6 < 4;
        if (is_possible) BLAMES(&lake, given, 4, PLANNER_STATUS_OK, "", -1);
        if (!is_possible) BLAMES(&lake, given, 4, PLANNER_STATUS_CHART, "chart", -1);
    }
    const double no_sides[] = {0.0, -1.0, 5e-6, 410.0, 1e300, 0.0 / 0.0, 1.0 / 0.0};
    for (size_t i = 0; i < sizeof no_sides / sizeof *no_sides; i++) {
        chart = all, chart.side = no_sides[i];
        BLAMES(&lake, given, 4, PLANNER_STATUS_CHART, "chart", -1);
    }
    chart = all, chart.corner.x = 8180.0; /* its other corner is too far */
    BLAMES(&lake, given, 4, PLANNER_STATUS_CHART, "chart", -1);
    chart.corner.x = 9000.0;
    BLAMES(&lake, given, 4, PLANNER_STATUS_POSITION, "chart", -1);
    chart.corner.x = 0.0 / 0.0;
    BLAMES(&lake, given, 4, PLANNER_STATUS_POSITION, "chart", -1);
    chart = all, lake.tolerance = 11.0;
    BLAMES(&lake, given, 4, PLANNER_STATUS_TOLERANCE_TOO_LARGE, "tolerance", -1);
    lake.tolerance = 0.0;
    planner_area area = {.keep_out_count = 1, .keep_outs = {{.corner_count = 1, .corners = {{5.0, 6.0}}, .radius = 1.0}}};
    lake.area = &area;
    BLAMES(&lake, given, 4, PLANNER_STATUS_OK, "", -1);
    area.keep_outs[0].radius = -1.0;
    BLAMES(&lake, given, 4, PLANNER_STATUS_KEEP_OUT, "keep_outs", 0);
    return failed;
}

/* Areas and keep-outs, and what a check says of each part of a mission. */
static int areas(const planner_mission *good, const planner_sample *given) {
    int failed = 0;
    planner_mission bad = *good;
    BLAMES(good, given, 4, PLANNER_STATUS_OK, "", -1);
    bad.p = 0.0 / 0.0;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "p", -1);
    bad = *good, bad.tolerance = 2000.0;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "tolerance", -1);
    bad = *good, bad.slopes = -1.0;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "slopes", -1);
    bad = *good, bad.sharpest = 4.0;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "sharpest", -1);
    bad = *good, bad.turn_step_urad = 0;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "turn_step_urad", -1);
    bad = *good, bad.step_mm = 0;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "step_mm", -1);
    bad = *good, bad.steps = 65535;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "steps", -1);
    bad = *good, bad.steps = 0;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "steps", -1);
    bad = *good, bad.min_z = 30.0;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "max_z", -1);
    bad = *good, bad.max_x = 1e9;
    BLAMES(&bad, given, 4, PLANNER_STATUS_POSITION, "max_x", -1);
    /* A level is of doubtful labels alone. */
    bad = *good, bad.level = 0.9;
    BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "level", -1);
    const double no_levels[] = {-0.1, 0.99995, 1.0, 0.0 / 0.0};
    for (size_t i = 0; i < sizeof no_levels / sizeof *no_levels; i++) {
        bad = *good, bad.p = 0.85, bad.level = no_levels[i];
        BLAMES(&bad, given, 4, PLANNER_STATUS_MISSION, "level", -1);
    }
    bad.level = 0.9999;
    BLAMES(&bad, given, 4, PLANNER_STATUS_OK, "", -1);

    /* Samples, by their number. */
    planner_sample samples[17];
    for (int i = 0; i < 17; i++) samples[i] = given[i % 4];
    BLAMES(good, samples, 17, PLANNER_STATUS_GIVEN, "given", -1);
    BLAMES(good, given, 2, PLANNER_STATUS_GIVEN, "given", -1);
    samples[2].is_positive = 2;
    BLAMES(good, samples, 4, PLANNER_STATUS_GIVEN, "given", 2);
    samples[2] = given[2], samples[1].x = 9000.0;
    BLAMES(good, samples, 4, PLANNER_STATUS_POSITION, "given", 1);
    const planner_sample inseparable[] = {{0.0, 0.0, 0}, {4.0, 0.0, 1}, {0.0, 4.0, 1}, {8.0, 0.0, 1}, {8.0, 1.0, 0}};
    BLAMES(good, inseparable, 5, PLANNER_STATUS_GIVEN, "given", 4);
    bad = *good, bad.p = 0.85;
    BLAMES(&bad, inseparable, 5, PLANNER_STATUS_GIVEN, "given", 4);

    /* A square with a keep-out, which needs no corners of its own. */
    planner_area area = {.keep_out_count = 1, .keep_outs = {{.corner_count = 1, .corners = {{5.0, 6.0}}, .radius = 1.0}}};
    planner_mission lawn = *good;
    lawn.area = &area;
    BLAMES(&lawn, given, 4, PLANNER_STATUS_OK, "", -1);
    const planner_area one = area;
    const planner_point square[] = {{12.0, 12.0}, {20.0, 12.0}, {20.0, 20.0}, {12.0, 20.0}};
    memcpy(area.keep_outs[1].corners, square, sizeof square);
    area.keep_outs[1].corner_count = 4, area.keep_out_count = 2;
    BLAMES(&lawn, given, 4, PLANNER_STATUS_OK, "", -1);
    area.keep_outs[1].corners[2].x = 13.0, area.keep_outs[1].corners[2].z = 13.0; /* it is dented */
    BLAMES(&lawn, given, 4, PLANNER_STATUS_KEEP_OUT, "keep_outs", 1);
    area = one, area.keep_outs[0].corners[0].z = 9000.0;
    BLAMES(&lawn, given, 4, PLANNER_STATUS_KEEP_OUT, "keep_outs", 0);
    const double no_radii[] = {-1.0, 8191.999991, 8192.0, 1e300, 0.0 / 0.0};
    for (size_t i = 0; i < sizeof no_radii / sizeof *no_radii; i++) {
        area = one, area.keep_outs[0].radius = no_radii[i];
        BLAMES(&lawn, given, 4, PLANNER_STATUS_KEEP_OUT, "keep_outs", 0);
    }
    /* Counts are bytes, and may be any. */
    for (int byte = 0; byte < 256; byte++) {
        area = one, area.keep_out_count = (uint8_t)byte;
        if (byte > 8) BLAMES(&lawn, given, 4, PLANNER_STATUS_KEEP_OUT, "keep_outs", -1);
        area = one, area.keep_outs[0].corner_count = (uint8_t)byte;
        if (byte != 1 && byte != 2) BLAMES(&lawn, given, 4, PLANNER_STATUS_KEEP_OUT, "keep_outs", 0);
        lawn.max_x = lawn.max_z = 0.0;
        area = one, area.corner_count = (uint8_t)byte;
        if (byte > 0) BLAMES(&lawn, given, 4, PLANNER_STATUS_AREA, "area", -1);
        lawn.max_x = lawn.max_z = 20.0;
    }
    /* Corners in the place of the rectangle, not beside it. */
    const planner_point border[] = {{0.0, 0.0}, {20.0, 0.0}, {20.0, 17.0}, {8.0, 20.0}, {0.0, 20.0}};
    memcpy(area.corners, border, sizeof border);
    area.corner_count = 5;
    BLAMES(&lawn, given, 4, PLANNER_STATUS_AREA, "area", -1);
    lawn.max_x = lawn.max_z = 0.0;
    BLAMES(&lawn, given, 4, PLANNER_STATUS_OK, "", -1);
    area.corner_count = 2;
    BLAMES(&lawn, given, 4, PLANNER_STATUS_AREA, "area", -1);
    area.corner_count = 5, area.corners[1].x = 1.0, area.corners[1].z = 10.0; /* it is dented */
    BLAMES(&lawn, given, 4, PLANNER_STATUS_AREA, "area", -1);
    memcpy(area.corners, border, sizeof border);
    area.corners[4].z = 9000.0;
    BLAMES(&lawn, given, 4, PLANNER_STATUS_AREA, "area", -1);
    memcpy(area.corners, border, sizeof border);
    lawn.tolerance = 11.0;
    BLAMES(&lawn, given, 4, PLANNER_STATUS_TOLERANCE_TOO_LARGE, "tolerance", -1);

    failed |= charts(good, given);

    BLAMES(NULL, given, 4, PLANNER_STATUS_MEMORY, "", -1);
    BLAMES(good, NULL, 4, PLANNER_STATUS_MEMORY, "", -1);
    return failed;
}

/* Observations that bring a tolerance or a reliability of their own, and the chance of +1. */
static int observations(const planner_mission *good, const planner_mission *doubtful, const planner_sample *given) {
    int failed = 0;
    const planner_pose pose = {10.0, 8.0, 0.0};
    const planner_point here = {10.0, 8.0}, far = {9000.0, 0.0};
    const int32_t positive = PLANNER_READING_POSITIVE;
    double chance = 7.0;
    planner_mission vague = *good, doubtful_and_vague = *doubtful;
    vague.tolerance = doubtful_and_vague.tolerance = 0.1;
    const planner_mission *missions[] = {good, doubtful, &vague, &doubtful_and_vague};
    for (int i = 0; i < 4; i++) {
        planner_t *planner = NULL;
        IS(planner_begin(&planner, memory, sizeof memory, missions[i], given, 4), PLANNER_STATUS_OK);
        IS(planner_chance(planner, far, &chance), PLANNER_STATUS_POSITION);
        IS(planner_chance(planner, here, NULL), PLANNER_STATUS_MEMORY);
        IS(chance == 7.0, 1);
        IS(planner_observe_within(planner, pose, positive, missions[i]->tolerance + 0.01), PLANNER_STATUS_TOLERANCE);
        IS(planner_observe_within(planner, pose, positive, 0.0 / 0.0), PLANNER_STATUS_TOLERANCE);
        IS(planner_observe_on_the_way(planner, here, PLANNER_READING_NONE), PLANNER_STATUS_OK);
        IS(planner_observe_believed(planner, pose, positive, 1.1), PLANNER_STATUS_RELIABILITY);
        IS(planner_observe_believed(planner, pose, positive, -0.1), PLANNER_STATUS_RELIABILITY);
        IS(planner_observe_believed(planner, pose, positive, 0.0 / 0.0), PLANNER_STATUS_RELIABILITY);
        /* One of its own is for doubtful labels at exact positions. */
        bool takes_it = i == 1;
        planner_status expected = takes_it ? PLANNER_STATUS_OK : PLANNER_STATUS_RELIABILITY;
        IS(planner_bits(planner) < 1e-6, 1);
        IS(planner_observe_believed(planner, pose, positive, 0.7), expected);
        IS(planner_bits(planner) > 1e-6, takes_it);
        IS(planner_observe_believed(planner, pose, positive, missions[i]->p), PLANNER_STATUS_OK);
        IS(planner_chance(planner, here, &chance), PLANNER_STATUS_OK);
        IS(chance > 0.5 && chance <= 1.0, 1);
        chance = 7.0;
        if (!takes_it) continue;
        /* Two labels that are certain and contradict each other: the second leaves all as it was. */
        planner_motion before, after;
        planner_pose close = pose;
        close.z += 0.01;
        IS(planner_observe_believed(planner, pose, positive, 1.0), PLANNER_STATUS_OK);
        IS(planner_plan(planner, pose, &before), PLANNER_STATUS_OK);
        double bits = planner_bits(planner);
        IS(planner_observe_believed(planner, pose, PLANNER_READING_NEGATIVE, 1.0), PLANNER_STATUS_CONTRADICTION);
        IS(planner_observe_believed(planner, pose, positive, 0.0), PLANNER_STATUS_CONTRADICTION);
        IS(planner_bits(planner) == bits, 1);
        IS(planner_plan(planner, pose, &after), PLANNER_STATUS_OK);
        IS(before.target.x == after.target.x && before.target.z == after.target.z, 1);
        IS(planner_observe_believed(planner, close, PLANNER_READING_BOUNDARY, 0.7), PLANNER_STATUS_OK);
        IS(planner_observe_believed(planner, close, PLANNER_READING_NONE, 0.7), PLANNER_STATUS_OK);
        IS(planner_bits(planner) == bits, 1);
        planner_status status = PLANNER_STATUS_OK;
        for (int labels = 0; labels < 40 && status == PLANNER_STATUS_OK; labels++) {
            close.x -= 0.2;
            status = planner_observe_believed(planner, close, positive, 0.7);
        }
        IS(status, PLANNER_STATUS_FULL);
    }
    return failed;
}

/* Snapshots that are spoilt, of another version, or of another mission. */
static int snapshots(const planner_mission *good, const planner_mission *doubtful, const planner_sample *given) {
    int failed = 0;
    const planner_mission *missions[] = {good, doubtful};
    const planner_pose pose = {10.0, 8.0, 0.0};
    planner_snapshot saved[2], spoilt;
    for (int i = 0; i < 2; i++) {
        planner_t *planner = NULL;
        IS(planner_begin(&planner, memory, sizeof memory, missions[i], given, 4), PLANNER_STATUS_OK);
        IS(planner_observe(planner, pose, PLANNER_READING_POSITIVE), PLANNER_STATUS_OK);
        IS(planner_save(planner, &saved[i]), PLANNER_STATUS_OK);
        IS(saved[i].count > 40 && saved[i].count < 120, 1);
    }
    for (int i = 0; i < 2; i++) {
        planner_t *planner = NULL;
        planner_motion before, after;
        IS(planner_begin(&planner, memory, sizeof memory, missions[i], given, 4), PLANNER_STATUS_OK);
        IS(planner_observe(planner, pose, PLANNER_READING_POSITIVE), PLANNER_STATUS_OK);
        IS(planner_plan(planner, pose, &before), PLANNER_STATUS_OK);
        double bits = planner_bits(planner);
        IS(planner_restore(planner, &saved[1 - i]), PLANNER_STATUS_SNAPSHOT_MISSION);
        for (uint32_t byte = 0; byte < saved[i].count; byte++) {
            spoilt = saved[i], spoilt.bytes[byte] ^= (uint8_t)(1u << byte % 8);
            IS(planner_restore(planner, &spoilt), PLANNER_STATUS_SNAPSHOT_SPOILT);
        }
        const uint32_t counts[] = {0, 1, 3, 4, saved[i].count - 1, saved[i].count + 1, 1021, 0xffffffff};
        for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
            spoilt = saved[i], spoilt.count = counts[k];
            IS(planner_restore(planner, &spoilt), PLANNER_STATUS_SNAPSHOT_SPOILT);
        }
        /* The version comes first, the check sum last. */
        spoilt = saved[i], spoilt.bytes[0] += 1;
        seal(spoilt.bytes, spoilt.count);
        IS(planner_restore(planner, &spoilt), PLANNER_STATUS_SNAPSHOT_VERSION);
        spoilt = saved[i], spoilt.bytes[1] = 2; /* so many given samples */
        seal(spoilt.bytes, spoilt.count);
        IS(planner_restore(planner, &spoilt), PLANNER_STATUS_SNAPSHOT_MISSION);
        for (int erased = 0; erased < 256; erased += 255) {
            memset(&spoilt, erased, sizeof spoilt);
            IS(planner_restore(planner, &spoilt), PLANNER_STATUS_SNAPSHOT_SPOILT);
        }
        /* What was refused left it as it was. */
        IS(planner_bits(planner) == bits, 1);
        IS(planner_plan(planner, pose, &after), PLANNER_STATUS_OK);
        IS(before.target.x == after.target.x && before.target.z == after.target.z, 1);
        IS(planner_restore(planner, &saved[i]), PLANNER_STATUS_OK);
        IS(planner_bits(planner) == bits, 1);
    }
    /* With a full buffer, and as far from the origin as a position can be: there is room for all of it. */
    planner_mission far = *doubtful;
    const planner_sample corners[] = {{8160.0, -8190.0, 0}, {8160.0, -8170.0, 1}, {8190.0, -8170.0, 1}, {8190.0, -8190.0, 0}};
    far.min_x = 8160.0, far.max_x = 8190.0, far.min_z = -8190.0, far.max_z = -8160.0, far.tolerance = 0.1;
    for (int i = 0; i < 2; i++) {
        planner_t *planner = NULL;
        planner_status status = PLANNER_STATUS_OK;
        far.p = i == 0 ? 1.0 : 0.85;
        IS(planner_begin(&planner, memory, sizeof memory, &far, corners, 4), PLANNER_STATUS_OK);
        planner_pose at = {8170.0, -8180.3, 3.0};
        for (int labels = 0; labels < 100; labels++) {
            at.x += 0.1, at.z += labels % 2 == 0 ? 1.3 : -1.2999;
            int32_t reading = at.z > -8180.0 ? PLANNER_READING_POSITIVE : PLANNER_READING_NEGATIVE;
            status = planner_observe_within(planner, at, reading, 0.001 * (labels % 90));
            if (status != PLANNER_STATUS_OK) break;
        }
        /* True labels that no longer matter make room. */
        IS(status, i == 0 ? PLANNER_STATUS_OK : PLANNER_STATUS_FULL);
        IS(planner_save(planner, &spoilt), PLANNER_STATUS_OK);
        printf("%u bytes to keep at most\n", (unsigned)spoilt.count);
        IS(planner_restore(planner, &spoilt), PLANNER_STATUS_OK);
    }
    return failed;
}

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

    IS(planner_begin(&planner, at, planner_bytes(&good) - 1, &good, given, 4), PLANNER_STATUS_MEMORY);
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
    const planner_pose pose = {2.0, 1.0, 0.0};
    planner_motion motion;
    planner_line line;
    IS(planner_observe(planner, pose, PLANNER_READING_POSITIVE), PLANNER_STATUS_CONTRADICTION);
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
    const planner_area flat = {.corner_count = 3, .corners = {{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}}};
    const planner_area crowd = {.keep_out_count = 9};
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
        planner_mission nowhere_to_go = *mission;
        nowhere_to_go.area = &crowd;
        IS(planner_begin(&planner, at, size, &nowhere_to_go, given, 4), PLANNER_STATUS_KEEP_OUT);
        nowhere_to_go.area = &flat, nowhere_to_go.max_x = nowhere_to_go.max_z = 0.0;
        IS(planner_begin(&planner, at, size, &nowhere_to_go, given, 4), PLANNER_STATUS_AREA);
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

    failed |= areas(&good, given);
    failed |= observations(&good, &doubtful, given);
    failed |= snapshots(&good, &doubtful, given);
    return failed;
}
