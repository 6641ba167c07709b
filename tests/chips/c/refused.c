/* Refuses each call in each way that it can, of each kind of planner: neither the planner nor a place for a result changes
 * by a single byte.
 */
#include "planner.h"
#include "seal.h"

#include <stdio.h>
#include <string.h>

#define WORDS(bytes) ((bytes) / sizeof(uint64_t))

static int failed = 0;

/* All that a call can write to. */
static struct {
    uint64_t planner[WORDS(PLANNER_DOUBTFUL_BYTES)];
    planner_t *made;
    planner_follower_t *follows;
    planner_motion motion;
    planner_line line;
    double chance;
    planner_snapshot snapshot;
    planner_front_place place;
    planner_front_crossing crossing;
    uint8_t saved[PLANNER_FOLLOWER_SNAPSHOT_BYTES];
    size_t count;
} all, before;

static void is(planner_status got, planner_status expected, int line) {
    bool is_alike = memcmp(&all, &before, sizeof all) == 0;
    if (got != expected || !is_alike || !planner_is_refused(got) || planner_has_ended(got)) {
        fprintf(stderr, "line %d: %d%s\n", line, (int)got, is_alike ? "" : ", and it changed something");
        failed = 1;
    }
}

#define REFUSED(call, expected) (memcpy(&before, &all, sizeof all), is(call, PLANNER_STATUS_##expected, __LINE__))
/* What the planner of a line remembers stays. Of what it has taken back there may be bytes left in its memory. */
#define FORGOTTEN(call, expected) \
    do { \
        planner_snapshot told, then; \
        DONE(planner_save(all.made, &told)); \
        memcpy(&before, &all, sizeof all); \
        planner_status got = (call); \
        memcpy(before.planner, all.planner, sizeof all.planner); \
        is(got, PLANNER_STATUS_##expected, __LINE__); \
        DONE(planner_save(all.made, &then)); \
        if (memcmp(&told, &then, sizeof told) != 0) failed = 1, fprintf(stderr, "line %d: it is remembered\n", __LINE__); \
    } while (0)
#define DONE(call) \
    do { \
        planner_status got = (call); \
        if (got != PLANNER_STATUS_OK || planner_is_refused(got) || planner_has_ended(got)) { \
            fprintf(stderr, "line %d: %d\n", __LINE__, (int)got); \
            failed = 1; \
        } \
    } while (0)

static const planner_sample given[] = {{2.0, 1.0, 0}, {2.0, 8.0, 1}, {18.0, 16.0, 1}, {18.0, 5.0, 0}};
static const planner_pose here = {10.0, 8.0, 0.0}, nowhere = {10.0, 8.0, 0.0 / 0.0};
static const planner_point at = {10.0, 8.0}, far = {9000.0, 0.0};
static const int32_t positive = PLANNER_READING_POSITIVE;

static planner_mission mission(double p, double tolerance) {
    planner_mission it = {
        .max_x = 20.0, .max_z = 20.0, .p = p, .tolerance = tolerance, .sharpest = 1.57, .turn_step_urad = 10000,
        .step_mm = 50, .steps = 20,
    };
    return it;
}

/* Its bytes once its snapshot's count is off by so many, and a bit of them. */
static planner_snapshot spoilt(planner_snapshot it, int more, int bit) {
    it.count += more;
    it.bytes[5] ^= bit;
    return it;
}

static void finds(double p, double tolerance) {
    const planner_mission good = mission(p, tolerance), bad = mission(0.5, 0.0), vague = mission(p, 10.0);
    const planner_sample apart[] = {{0.0, 0.0, 1}, {1.0, 0.0, 0}, {2.0, 0.0, 1}, {1.0, 1.0, 1}};
    size_t bytes = planner_bytes(&good);
    void *memory = all.planner;
    const planner_chart chart = {.columns = 40, .rows = 40, .side = 0.5}; /* without cells */
    planner_mission lake = good;
    lake.max_x = lake.max_z = 0.0, lake.chart = &chart;
    memset(&all, 0xa5, sizeof all);
    all.made = NULL;
    if (planner_bytes(&good) > (p < 1.0 ? PLANNER_DOUBTFUL_BYTES : PLANNER_BYTES)) failed = 1;
    for (int round = 0; round < 2; round++) {
        /* First there is no planner, then there is one that has been told something. */
        REFUSED(planner_begin(NULL, memory, bytes, &good, given, 4), MEMORY);
        REFUSED(planner_begin(&all.made, NULL, bytes, &good, given, 4), MEMORY);
        REFUSED(planner_begin(&all.made, (uint8_t *)memory + PLANNER_ALIGNMENT / 2, bytes, &good, given, 4), MEMORY);
        REFUSED(planner_begin(&all.made, memory, bytes - 1, &good, given, 4), MEMORY);
        REFUSED(planner_begin(&all.made, memory, bytes, NULL, given, 4), MEMORY);
        REFUSED(planner_begin(&all.made, memory, bytes, &good, NULL, 4), MEMORY);
        REFUSED(planner_begin(&all.made, memory, bytes, &good, NULL, 0), GIVEN);
        REFUSED(planner_begin(&all.made, memory, bytes, &good, given, 17), GIVEN);
        REFUSED(planner_begin(&all.made, memory, bytes, &good, apart, 4), GIVEN);
        REFUSED(planner_begin(&all.made, memory, bytes, &bad, given, 4), MISSION);
        REFUSED(planner_begin(&all.made, memory, bytes, &vague, given, 4), TOLERANCE_TOO_LARGE);
        REFUSED(planner_begin(&all.made, memory, bytes, &lake, given, 4), MEMORY);
        lake.max_x = 20.0;
        REFUSED(planner_begin(&all.made, memory, bytes, &lake, given, 4), CHART);
        lake.max_x = 0.0;
        if (round > 0) break;
        DONE(planner_begin(&all.made, memory, bytes, &good, given, 4));
        DONE(planner_plan(all.made, here, &all.motion));
        DONE(planner_observe(all.made, here, positive));
        DONE(planner_save(all.made, &all.snapshot));
    }
    REFUSED(planner_plan(NULL, here, &all.motion), MEMORY);
    REFUSED(planner_plan(all.made, here, NULL), MEMORY);
    REFUSED(planner_plan(all.made, nowhere, &all.motion), POSITION);
    REFUSED(planner_observe(NULL, here, positive), MEMORY);
    REFUSED(planner_observe(all.made, nowhere, positive), POSITION);
    REFUSED(planner_observe(all.made, here, 3), READING);
    REFUSED(planner_observe_within(NULL, here, positive, 0.0), MEMORY);
    REFUSED(planner_observe_within(all.made, nowhere, positive, 0.0), POSITION);
    REFUSED(planner_observe_within(all.made, here, 3, 0.0), READING);
    REFUSED(planner_observe_within(all.made, here, positive, tolerance + 0.01), TOLERANCE);
    REFUSED(planner_observe_within(all.made, here, positive, -0.01), TOLERANCE);
    REFUSED(planner_observe_believed(NULL, here, positive, p), MEMORY);
    REFUSED(planner_observe_believed(all.made, nowhere, positive, p), POSITION);
    REFUSED(planner_observe_believed(all.made, here, 3, p), READING);
    REFUSED(planner_observe_believed(all.made, here, positive, 1.1), RELIABILITY);
    if (p == 1.0 || tolerance > 0.0) FORGOTTEN(planner_observe_believed(all.made, here, positive, 0.7), RELIABILITY);
    REFUSED(planner_observe_on_the_way(NULL, at, positive), MEMORY);
    REFUSED(planner_observe_on_the_way(all.made, far, positive), POSITION);
    REFUSED(planner_observe_on_the_way(all.made, at, 3), READING);
    if (p == 1.0) {
        const planner_point below = {18.0, 4.0};
        const planner_pose there = {18.0, 4.0, 0.0};
        FORGOTTEN(planner_observe(all.made, there, positive), CONTRADICTION);
        FORGOTTEN(planner_observe_on_the_way(all.made, below, positive), CONTRADICTION);
    }
    REFUSED(planner_estimate(NULL, &all.line), MEMORY);
    REFUSED(planner_estimate(all.made, NULL), MEMORY);
    REFUSED(planner_chance(NULL, at, &all.chance), MEMORY);
    REFUSED(planner_chance(all.made, at, NULL), MEMORY);
    REFUSED(planner_chance(all.made, far, &all.chance), POSITION);
    REFUSED(planner_save(NULL, &all.snapshot), MEMORY);
    REFUSED(planner_save(all.made, NULL), MEMORY);
    const planner_mission wide = mission(p, tolerance + 0.001);
    const planner_snapshot cut = spoilt(all.snapshot, -1, 0), flipped = spoilt(all.snapshot, 0, 4);
    planner_snapshot other;
    uint64_t elsewhere[WORDS(PLANNER_DOUBTFUL_BYTES)];
    planner_t *planner;
    DONE(planner_begin(&planner, elsewhere, sizeof elsewhere, &wide, given, 4));
    DONE(planner_save(planner, &other));
    REFUSED(planner_restore(NULL, &all.snapshot), MEMORY);
    REFUSED(planner_restore(all.made, NULL), MEMORY);
    REFUSED(planner_restore(all.made, &cut), SNAPSHOT_SPOILT);
    REFUSED(planner_restore(all.made, &flipped), SNAPSHOT_SPOILT);
    REFUSED(planner_restore(all.made, &other), SNAPSHOT_MISSION);
    DONE(planner_restore(all.made, &all.snapshot));
    /* Bytes with a right check sum that contradict each other, some only when half of them are replayed. */
    unsigned refused = 0;
    for (uint32_t bit = 0; bit < 8 * (all.snapshot.count - 4); bit++) {
        planner_snapshot turned = all.snapshot, told, then;
        turned.bytes[bit / 8] ^= 1 << bit % 8;
        seal(turned.bytes, turned.count);
        DONE(planner_save(all.made, &told));
        if (planner_is_refused(planner_restore(all.made, &turned))) {
            refused++;
            DONE(planner_save(all.made, &then));
            if (memcmp(&told, &then, sizeof told) != 0) failed = 1, fprintf(stderr, "bit %u stays\n", (unsigned)bit);
        }
        DONE(planner_restore(all.made, &all.snapshot));
    }
    if (refused < 100) failed = 1, fprintf(stderr, "only %u bits are refused\n", refused);
}

/* What is said of front settings, and of which of their parts. */
static void blames(planner_mission it, planner_front_settings front, const planner_sample *samples, size_t count,
                   planner_status said, const char *part, int number) {
    planner_verdict verdict = planner_follower_check(&it, front, samples, count);
    if (verdict.status != said || strcmp(verdict.what, part) != 0 || verdict.number != number) {
        fprintf(stderr, "%s: %d %s %d\n", part, (int)verdict.status, verdict.what, (int)verdict.number);
        failed = 1;
    }
    uint64_t memory[WORDS(PLANNER_FOLLOWER_BYTES)];
    planner_follower_t *none = NULL;
    if (planner_follow(&none, memory, sizeof memory, &it, front, samples, count) != said) failed = 1;
}

static void follows(double stretch) {
    const planner_mission good = mission(0.9, 0.1), vague = mission(0.9, 10.0);
    const planner_front_settings front = {.radius = 5.0, .speed = 0.01, .stretch = stretch};
    const planner_sample near[] = {{10.0, 7.0, 0}, {10.0, 8.0, 1}};
    size_t bytes = planner_follower_bytes(), count = 0;
    void *memory = all.planner;
    memset(&all, 0xa5, sizeof all);
    all.follows = NULL;
    if (bytes > PLANNER_FOLLOWER_BYTES) failed = 1;
    planner_front_settings odd = front;
    odd.speed = -1.0;
    for (int round = 0; round < 2; round++) {
        REFUSED(planner_follow(NULL, memory, bytes, &good, front, near, 2), MEMORY);
        REFUSED(planner_follow(&all.follows, NULL, bytes, &good, front, near, 2), MEMORY);
        REFUSED(planner_follow(&all.follows, (uint8_t *)memory + PLANNER_ALIGNMENT / 2, bytes, &good, front, near, 2),
                MEMORY);
        if (stretch > 0.0) REFUSED(planner_follow(&all.follows, memory, bytes - 1, &good, front, near, 2), MEMORY);
        REFUSED(planner_follow(&all.follows, memory, 8000, &good, front, near, 2), MEMORY);
        REFUSED(planner_follow(&all.follows, memory, bytes, NULL, front, near, 2), MEMORY);
        REFUSED(planner_follow(&all.follows, memory, bytes, &good, front, NULL, 2), MEMORY);
        REFUSED(planner_follow(&all.follows, memory, bytes, &good, front, near, 17), GIVEN);
        REFUSED(planner_follow(&all.follows, memory, bytes, &good, odd, near, 2), MISSION);
        REFUSED(planner_follow(&all.follows, memory, bytes, &vague, front, near, 2), TOLERANCE_TOO_LARGE);
        if (round > 0) break;
        DONE(planner_follow(&all.follows, memory, bytes, &good, front, NULL, 0));
        REFUSED(planner_front(all.follows, &all.place), UNKNOWN);
        REFUSED(planner_front_beside(all.follows, here, &all.crossing), UNKNOWN);
        DONE(planner_follower_chance(all.follows, at, &all.chance));
        if (all.chance != 0.5) failed = 1;
        DONE(planner_follow(&all.follows, memory, bytes, &good, front, near, 2));
        DONE(planner_follower_plan(all.follows, here, &all.motion));
        DONE(planner_follower_observe(all.follows, here, positive));
        DONE(planner_follower_chance(all.follows, at, &all.chance));
        if (!(all.chance > 0.5 && all.chance < 0.9)) failed = 1;
        DONE(planner_follower_save(all.follows, all.saved, sizeof all.saved, &all.count));
    }
    REFUSED(planner_follower_plan(NULL, here, &all.motion), MEMORY);
    REFUSED(planner_follower_plan(all.follows, here, NULL), MEMORY);
    REFUSED(planner_follower_plan(all.follows, nowhere, &all.motion), POSITION);
    REFUSED(planner_follower_observe(NULL, here, positive), MEMORY);
    REFUSED(planner_follower_observe(all.follows, nowhere, positive), POSITION);
    REFUSED(planner_follower_observe(all.follows, here, 3), READING);
    REFUSED(planner_follower_observe_within(NULL, here, positive, 0.0), MEMORY);
    REFUSED(planner_follower_observe_within(all.follows, nowhere, positive, 0.0), POSITION);
    REFUSED(planner_follower_observe_within(all.follows, here, 3, 0.0), READING);
    REFUSED(planner_follower_observe_within(all.follows, here, positive, 0.11), TOLERANCE);
    REFUSED(planner_follower_observe_within(all.follows, here, positive, -0.01), TOLERANCE);
    REFUSED(planner_follower_observe_on_the_way(NULL, at, positive), MEMORY);
    REFUSED(planner_follower_observe_on_the_way(all.follows, far, positive), POSITION);
    REFUSED(planner_follower_observe_on_the_way(all.follows, at, 3), READING);
    REFUSED(planner_follower_chance(NULL, at, &all.chance), MEMORY);
    REFUSED(planner_follower_chance(all.follows, at, NULL), MEMORY);
    REFUSED(planner_follower_chance(all.follows, far, &all.chance), POSITION);
    REFUSED(planner_front(NULL, &all.place), MEMORY);
    REFUSED(planner_front(all.follows, NULL), MEMORY);
    REFUSED(planner_front_beside(NULL, here, &all.crossing), MEMORY);
    REFUSED(planner_front_beside(all.follows, here, NULL), MEMORY);
    REFUSED(planner_front_beside(all.follows, nowhere, &all.crossing), POSITION);
    /* With one byte too little the last snapshot stays. */
    REFUSED(planner_follower_save(NULL, all.saved, all.count, &all.count), MEMORY);
    REFUSED(planner_follower_save(all.follows, NULL, all.count, &all.count), MEMORY);
    REFUSED(planner_follower_save(all.follows, all.saved, all.count, NULL), MEMORY);
    for (size_t room = 0; room < all.count; room++) {
        REFUSED(planner_follower_save(all.follows, all.saved, room, &all.count), MEMORY);
    }
    DONE(planner_follower_save(all.follows, all.saved, all.count, &all.count));
    uint8_t other[PLANNER_FOLLOWER_SNAPSHOT_BYTES];
    uint64_t elsewhere[WORDS(PLANNER_FOLLOWER_BYTES)];
    planner_follower_t *follower;
    odd.speed = 0.02;
    DONE(planner_follow(&follower, elsewhere, sizeof elsewhere, &good, odd, near, 2));
    DONE(planner_follower_save(follower, other, sizeof other, &count));
    REFUSED(planner_follower_restore(NULL, all.saved, all.count), MEMORY);
    REFUSED(planner_follower_restore(all.follows, NULL, all.count), MEMORY);
    REFUSED(planner_follower_restore(all.follows, all.saved, 0), SNAPSHOT_SPOILT);
    REFUSED(planner_follower_restore(all.follows, all.saved, all.count - 1), SNAPSHOT_SPOILT);
    REFUSED(planner_follower_restore(all.follows, other, count), SNAPSHOT_MISSION);
    other[20] ^= 1;
    REFUSED(planner_follower_restore(all.follows, other, count), SNAPSHOT_SPOILT);
    DONE(planner_follower_restore(all.follows, all.saved, all.count));
    unsigned refused = 0;
    for (size_t byte = 0; byte < all.count - 4; byte++) {
        static uint8_t turned[PLANNER_FOLLOWER_SNAPSHOT_BYTES], then[PLANNER_FOLLOWER_SNAPSHOT_BYTES];
        memcpy(turned, all.saved, all.count);
        turned[byte] ^= 1 << (byte % 2 + 6);
        seal(turned, all.count);
        if (planner_is_refused(planner_follower_restore(all.follows, turned, all.count))) {
            refused++;
            DONE(planner_follower_save(all.follows, then, sizeof then, &count));
            if (memcmp(all.saved, then, all.count) != 0) failed = 1, fprintf(stderr, "byte %zu stays\n", byte);
        }
        DONE(planner_follower_restore(all.follows, all.saved, all.count));
    }
    if (refused < 100) failed = 1, fprintf(stderr, "only %u bytes are refused\n", refused);
}

int main(void) {
    finds(1.0, 0.0);
    finds(1.0, 0.1);
    finds(0.85, 0.0);
    finds(0.85, 0.1);
    follows(0.0);
    follows(10.0);

    const planner_front_settings front = {.radius = 5.0};
    planner_front_settings odd = front;
    planner_mission bad = mission(0.9, 0.0);
    blames(bad, front, given, 4, PLANNER_STATUS_OK, "", -1);
    blames(bad, front, NULL, 0, PLANNER_STATUS_OK, "", -1);
    blames(bad, front, NULL, 1, PLANNER_STATUS_MEMORY, "", -1);
    blames(bad, front, given, 17, PLANNER_STATUS_GIVEN, "given", -1);
    const planner_sample garbled[] = {{2.0, 1.0, 0}, {2.0, 8.0, 2}};
    blames(bad, front, garbled, 2, PLANNER_STATUS_GIVEN, "given", 1);
    bad.slopes = 0.1;
    blames(bad, front, given, 4, PLANNER_STATUS_MISSION, "slopes", -1);
    bad.slopes = 0.0, bad.level = 0.9;
    blames(bad, front, given, 4, PLANNER_STATUS_MISSION, "level", -1);
    bad.level = 0.0, bad.p = 0.5;
    blames(bad, front, given, 4, PLANNER_STATUS_MISSION, "p", -1);
    bad.p = 0.9, bad.steps = 0;
    blames(bad, front, given, 4, PLANNER_STATUS_MISSION, "steps", -1);
    bad.steps = 20;
    odd.radius = 0.09;
    blames(bad, odd, given, 4, PLANNER_STATUS_MISSION, "radius", -1);
    odd = front, odd.speed = -0.1;
    blames(bad, odd, given, 4, PLANNER_STATUS_MISSION, "speed", -1);
    const double no_stretches[] = {0.09, -1.0, 10001.0, 0.0 / 0.0};
    for (size_t i = 0; i < sizeof no_stretches / sizeof *no_stretches; i++) {
        odd = front, odd.stretch = no_stretches[i];
        blames(bad, odd, given, 4, PLANNER_STATUS_MISSION, "stretch", -1);
    }
    /* It is a byte, and may be any. */
    for (int byte = 0; byte < 256; byte++) {
        odd = front, odd.until_closed = (uint8_t)byte;
        blames(bad, odd, given, 4, byte > 1 ? PLANNER_STATUS_MISSION : PLANNER_STATUS_OK, byte > 1 ? "until_closed" : "", -1);
    }
    odd.until_closed = 1, odd.stretch = 10.0;
    blames(bad, odd, given, 4, PLANNER_STATUS_MISSION, "until_closed", -1);

    /* The groups of all statuses. */
    for (int status = 0; status < 128; status++) {
        bool ended = planner_has_ended(status), refused = planner_is_refused(status);
        if (ended + refused != (status != PLANNER_STATUS_OK)) failed = 1;
    }
    if (!planner_has_ended(PLANNER_STATUS_KNOWN) || !planner_has_ended(PLANNER_STATUS_ONE_LABEL)) failed = 1;
    if (!planner_is_refused(PLANNER_STATUS_CONTRADICTION) || !planner_is_refused(PLANNER_STATUS_UNKNOWN)) failed = 1;
    return failed;
}
