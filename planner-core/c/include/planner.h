/* A planner that finds a boundary from few yes-or-no readings. Made from planner-core/c/src: change it there.
 *
 * A mission is a struct of numbers. `planner_begin` makes a planner of a straight boundary in your memory, and
 * `planner_check` says what it would refuse. Ask `planner_plan` for a motion, make it, and tell `planner_observe` where it
 * ended and what was read. An observation can bring a tolerance or a reliability of its own. `planner_estimate`,
 * `planner_chance` and `planner_bits` read out what is known. `planner_save` and `planner_restore` carry a planner over a
 * sleep: it makes the same plans as if it had stayed awake.
 *
 * `planner_follow` makes a planner of another kind: it goes along a front that bends and moves, or stays with a stretch of
 * it. What it is asked begins with `planner_follower`, and `planner_front` says where the front is.
 *
 * Nothing is allocated, and all capacities are fixed. A call that is refused says why and changes nothing, places for
 * results included. Names and meanings stay as they are; more may be added.
 */


#ifndef PLANNER_H
#define PLANNER_H



#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Define this for a library that is built without the feature `polygons`: its planners are smaller. */
#ifndef PLANNER_WITHOUT_POLYGONS
#define PLANNER_WITH_POLYGONS
/* The same without the feature `charts`. */
#ifndef PLANNER_WITHOUT_CHARTS
#define PLANNER_WITH_CHARTS
#endif
#endif

/* Words of a chart's cells. */
#define PLANNER_CHART_WORDS(columns, rows) (((columns) + 31) / 32 * (rows))

/*
 Corners that an area can have, and each keep-out in it.
 */
#define PLANNER_CORNERS 8

/*
 Keep-outs that an area can have.
 */
#define PLANNER_KEEP_OUTS 8

/*
 Rows and columns that a chart can have.
 */
#define PLANNER_CHART_CELLS 256

/*
 Memory of a planner is aligned to so many bytes.
 */
#define PLANNER_ALIGNMENT 8

#if defined(PLANNER_WITH_CHARTS)
/*
 Bytes of a planner whose labels are always right.
 */
#define PLANNER_BYTES 2320
#endif

#if (defined(PLANNER_WITH_POLYGONS) && !defined(PLANNER_WITH_CHARTS))
/*
 Bytes of a planner whose labels are always right.
 */
#define PLANNER_BYTES 2272
#endif

#if !defined(PLANNER_WITH_POLYGONS)
/*
 Bytes of a planner whose labels are always right.
 */
#define PLANNER_BYTES 1184
#endif

#if defined(PLANNER_WITH_CHARTS)
/*
 Bytes of a planner whose labels may be wrong.
 */
#define PLANNER_DOUBTFUL_BYTES 17224
#endif

#if (defined(PLANNER_WITH_POLYGONS) && !defined(PLANNER_WITH_CHARTS))
/*
 Bytes of a planner whose labels may be wrong.
 */
#define PLANNER_DOUBTFUL_BYTES 17176
#endif

#if !defined(PLANNER_WITH_POLYGONS)
/*
 Bytes of a planner whose labels may be wrong.
 */
#define PLANNER_DOUBTFUL_BYTES 16096
#endif

#if defined(PLANNER_WITH_CHARTS)
/*
 Bytes of a planner of fronts.
 */
#define PLANNER_FOLLOWER_BYTES 9768
#endif

#if (defined(PLANNER_WITH_POLYGONS) && !defined(PLANNER_WITH_CHARTS))
/*
 Bytes of a planner of fronts.
 */
#define PLANNER_FOLLOWER_BYTES 9720
#endif

#if !defined(PLANNER_WITH_POLYGONS)
/*
 Bytes of a planner of fronts.
 */
#define PLANNER_FOLLOWER_BYTES 8640
#endif

/*
 Bytes that a snapshot can have: those of a planner that is full, as far from the origin as a position can be, fit in.
 */
#define PLANNER_SNAPSHOT_BYTES 1100

/*
 Bytes that the snapshot of a planner of fronts can have.
 */
#define PLANNER_FOLLOWER_SNAPSHOT_BYTES 8800

/*
 What a call came to. The mission goes on, or it has ended, or the call is refused: `planner_has_ended` and
 `planner_is_refused` tell.
 */
typedef enum {
  /*
   It was done, and the mission goes on.
   */
  PLANNER_STATUS_OK = 0,
  /*
   Ended: the line is known as well as was asked for.
   */
  PLANNER_STATUS_KNOWN = 1,
  /*
   Ended: no motion leads to uncertain ground, as what is left of it is too thin or out of reach.
   */
  PLANNER_STATUS_RESOLUTION = 2,
  /*
   Ended: there is no room for another sample. An observation that says so is not taken in.
   */
  PLANNER_STATUS_FULL = 3,
  /*
   Ended: outside the area, or cornered.
   */
  PLANNER_STATUS_STUCK = 4,
  /*
   Ended: there is uncertain ground, but none of the ways that a plan tries leads there. From another pose one may.
   */
  PLANNER_STATUS_UNDECIDED = 5,
  /*
   Ended: what is uncertain is so thin that no label can tell more, as positions err.
   */
  PLANNER_STATUS_IMPRECISE = 6,
  /*
   Ended: no straight, still line explains the labels, as the audit before the goal's promise read another label on
   ground that was certain.
   */
  PLANNER_STATUS_NO_LINE = 7,
  /*
   Ended: the robot has gone along all of the front, and the front settings say that it ends then.
   */
  PLANNER_STATUS_CLOSED = 8,
  /*
   Ended: all of the area most likely has one label, so there is no front.
   */
  PLANNER_STATUS_ONE_LABEL = 9,
  /*
   Refused: the reading contradicts what is certain.
   */
  PLANNER_STATUS_CONTRADICTION = 64,
  /*
   Refused: a pointer is null, or the memory too small or not aligned to 8 bytes.
   */
  PLANNER_STATUS_MEMORY = 65,
  /*
   Refused: a number of the mission or of the front settings is out of its range.
   */
  PLANNER_STATUS_MISSION = 66,
  /*
   Refused: a position is further than 8,192 m from the origin, or no number.
   */
  PLANNER_STATUS_POSITION = 67,
  /*
   Refused: there is no such reading.
   */
  PLANNER_STATUS_READING = 68,
  /*
   Refused: no line separates the given samples, or they are collinear, too many or of one label. Or one says
   something else than 0 or 1 for whether it is positive.
   */
  PLANNER_STATUS_GIVEN = 69,
  /*
   Refused: the tolerance leaves nothing of the area, as no place is as far from its border.
   */
  PLANNER_STATUS_TOLERANCE_TOO_LARGE = 70,
  /*
   Refused: the area is no convex polygon, has too many corners, or comes beside a rectangle. Or the library is
   built without polygons.
   */
  PLANNER_STATUS_AREA = 71,
  /*
   Refused: a keep-out is no convex polygon, has too many corners or no possible radius, or there are too many.
   */
  PLANNER_STATUS_KEEP_OUT = 72,
  /*
   Refused: an observation's tolerance is above the mission's, or below 0, or no number.
   */
  PLANNER_STATUS_TOLERANCE = 73,
  /*
   Refused: an observation's `p` is no probability, or this mission takes no other `p` than its own.
   */
  PLANNER_STATUS_RELIABILITY = 74,
  /*
   Refused: the snapshot is spoilt, or never was one.
   */
  PLANNER_STATUS_SNAPSHOT_SPOILT = 75,
  /*
   Refused: another version of the planner made the snapshot.
   */
  PLANNER_STATUS_SNAPSHOT_VERSION = 76,
  /*
   Refused: a planner of this mission cannot have made the snapshot.
   */
  PLANNER_STATUS_SNAPSHOT_MISSION = 77,
  /*
   Refused: what is asked for is not known. The front is not found, or it is lost. Or the lines that are left lie
   too close together for single precision.
   */
  PLANNER_STATUS_UNKNOWN = 78,
  /*
   Refused: a chart has no possible side or size, leaves the ground within 8,192 m of the origin, or comes beside a
   rectangle. Or the library is built without charts.
   */
  PLANNER_STATUS_CHART = 79,
} planner_status;

/*
 What was read. It comes as a number, as an enumeration of C may hold any.
 */
enum planner_reading
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   The side of -1.
   */
  PLANNER_READING_NEGATIVE = -1,
  /*
   The line itself.
   */
  PLANNER_READING_BOUNDARY = 0,
  /*
   The side of +1.
   */
  PLANNER_READING_POSITIVE = 1,
  /*
   No label was asked for.
   */
  PLANNER_READING_NONE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum planner_reading planner_reading;
#else
typedef int32_t planner_reading;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 A planner, in memory of the caller.
 */
typedef struct planner_t planner_t;

/*
 A planner that goes along a front or watches a stretch of it, in memory of the caller.
 */
typedef struct planner_follower_t planner_follower_t;

/*
 A place.
 */
typedef struct {
  /*
   Metres.
   */
  double x;
  /*
   Metres.
   */
  double z;
} planner_point;

/*
 What no motion touches: all places within a radius of a point, of a straight wall or of a convex polygon.
 */
typedef struct {
  /*
   Its corners in order, either way round. One is a disc's middle, two are the ends of a wall.
   */
  planner_point corners[PLANNER_CORNERS];
  /*
   How far it reaches beyond them, metres.
   */
  double radius;
  /*
   How many corners it has, from 1 to `PLANNER_CORNERS`.
   */
  uint8_t corner_count;
} planner_keep_out;

/*
 Where motions may go: a convex polygon, but for keep-outs.
 */
typedef struct {
  /*
   The polygon's corners in order, either way round.
   */
  planner_point corners[PLANNER_CORNERS];
  /*
   What no motion touches.
   */
  planner_keep_out keep_outs[PLANNER_KEEP_OUTS];
  /*
   How many corners the polygon has, from 3 to `PLANNER_CORNERS`. Then the mission's rectangle is all zeros. Or 0
   for the mission's rectangle in place of a polygon.
   */
  uint8_t corner_count;
  /*
   How many keep-outs there are, up to `PLANNER_KEEP_OUTS`.
   */
  uint8_t keep_out_count;
} planner_area;

/*
 Square cells, of which each is open or closed. Motions stay on open cells, and all ground outside of them is closed.

 The words are not copied. A planner reads them with each call, so they stay where they are, and as they are, for as long
 as it is used. They may be in flash.
 */
typedef struct {
  /*
   `PLANNER_CHART_WORDS(columns, rows)` words: row by row, that of the least z first. A row begins with a word of its
   own. Bit `k` of its word `w` is column `32 w + k`, counted from the least x. 1 is open.
   */
  const uint32_t *cells;
  /*
   The corner with the least x and z, metres.
   */
  planner_point corner;
  /*
   The side of a cell, metres; it is rounded to a multiple of 2^-16 m.
   */
  double side;
  /*
   Columns, from 1 to `PLANNER_CHART_CELLS`.
   */
  uint16_t columns;
  /*
   Rows, from 1 to `PLANNER_CHART_CELLS`.
   */
  uint16_t rows;
} planner_chart;

/*
 What is fixed beforehand.
 */
typedef struct {
  /*
   The area's lower left corner, metres.
   */
  double min_x;
  /*
   The same.
   */
  double min_z;
  /*
   The area's upper right corner, metres.
   */
  double max_x;
  /*
   The same.
   */
  double max_z;
  /*
   How far a position may be off, metres; 0 if it is exact.
   */
  double tolerance;
  /*
   How often a label is right: 1 if always, else above 1/2. A library that is built without noise finds lines with
   1 alone.
   */
  double p;
  /*
   Stop when the slopes of all lines left, or with p below 1 of 90 % of them, differ by no more, radians; 0 to
   go on.
   */
  double slopes;
  /*
   The sharpest turn to either side, radians.
   */
  double sharpest;
  /*
   From one turn to the next, millionths of a radian.
   */
  uint32_t turn_step_urad;
  /*
   From one distance to the next, millimetres.
   */
  uint32_t step_mm;
  /*
   How many such steps the longest motion has.
   */
  uint16_t steps;
  /*
   With p below 1: the probability that `slopes` holds when the planner stops, at most 0.9999; 0 for 0.9. With p of
   1 it must be 0.
   */
  double level;
  /*
   A polygon and keep-outs; null for the rectangle with nothing in it. It is read while a call runs, and not after.
   A library that is built without polygons takes null alone.
   */
  const planner_area *area;
  /*
   A lake of any shape; null for all of the area. Then the mission's rectangle is all zeros: it is the one around all
   cells. `area` may have keep-outs. A library that is built without charts takes null alone.
   */
  const planner_chart *chart;
} planner_mission;

/*
 What is said of a mission before it begins, and which part of it that is about.
 */
typedef struct {
  /*
   What it says.
   */
  planner_status status;
  /*
   The number of the sample or of the keep-out that is refused, from 0; -1 if it is none of these.
   */
  int32_t number;
  /*
   What is refused: a field of the mission, of its area or of the front settings, `"given"` for the samples, `""` for
   nothing. Never null.
   */
  const char *what;
} planner_verdict;

/*
 A sample that is known before the mission.
 */
typedef struct {
  /*
   Metres.
   */
  double x;
  /*
   Metres.
   */
  double z;
  /*
   1 if it lies on the side of +1, 0 if on that of -1; `true` and `false` are these.
   */
  uint8_t is_positive;
} planner_sample;

/*
 Where the robot is.
 */
typedef struct {
  /*
   Metres.
   */
  double x;
  /*
   Metres.
   */
  double z;
  /*
   Counter-clockwise from the x axis, radians.
   */
  double heading;
} planner_pose;

/*
 A motion to make: first turn, then drive.
 */
typedef struct {
  /*
   How far to turn to the left, radians.
   */
  double turn;
  /*
   How far to drive, metres.
   */
  double drive;
  /*
   Where it leads.
   */
  planner_pose target;
  /*
   Whether a label is to be read at its end.
   */
  bool wants_label;
} planner_motion;

/*
 A line `a x + b z + c = 0` with a unit normal, positive on the side of +1.
 */
typedef struct {
  /*
   Of x.
   */
  double a;
  /*
   Of z.
   */
  double b;
  /*
   Metres.
   */
  double c;
} planner_line;

/*
 What a planner has to remember over a sleep. It may be kept as it is, or as its first `count` bytes alone.
 */
typedef struct {
  /*
   How many of the bytes belong to it; the others are zeros.
   */
  uint32_t count;
  /*
   The same on every machine.
   */
  uint8_t bytes[PLANNER_SNAPSHOT_BYTES];
} planner_snapshot;

/*
 How a front bends, how fast it moves, and what to do with it.
 */
typedef struct {
  /*
   0 for a straight line, and any radius from 0.1 m for a front that bends: only whether it bends counts.
   */
  double radius;
  /*
   How far the front may move in the time of a motion, metres. If in doubt, name a higher speed.
   */
  double speed;
  /*
   0 to go along the front. Or so many metres of it, from 0.1 to 10000, about the place where the planner finds it. The
   planner stays with them, and learns where the front is all along.
   */
  double stretch;
  /*
   1 to end once the robot has gone along all of the front: back to where it found it, or to the border at both ends.
   0 to go on. With a stretch it must be 0.
   */
  uint8_t until_closed;
} planner_front_settings;

/*
 Where a front is known best.
 */
typedef struct {
  /*
   On the mean front. The heading is the front's direction; the side of +1 is to the left.
   */
  planner_pose pose;
  /*
   1/m, positive where the front bends to the left.
   */
  double curvature;
  /*
   The standard deviation of the front across its direction, metres.
   */
  double deviation;
  /*
   The standard deviation of the direction, radians.
   */
  double turn_deviation;
  /*
   Whether the robot has gone along all of a closed front.
   */
  bool is_closed;
} planner_front_place;

/*
 Where a front crosses the line through a place that is square to a heading.
 */
typedef struct {
  /*
   How far to the left of the place, on average, metres.
   */
  double left;
  /*
   The standard deviation, metres.
   */
  double deviation;
} planner_front_crossing;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 How much memory the planner of a mission takes, bytes; 0 if `p` or `tolerance` is refused. Nothing else is checked.
 */
size_t planner_bytes(const planner_mission *mission);

/*
 What `planner_begin` will say of a mission and its given samples, and which part of them that is about. It needs no
 memory, and touches no planner.

 # Safety
 As for `planner_begin`.
 */
planner_verdict planner_check(const planner_mission *mission,
                              const planner_sample *given,
                              size_t count);

/*
 Makes a planner in so many bytes of memory that is aligned to 8, from 3 to 16 given samples of both labels, and
 writes where it is. It is that memory's beginning: there is nothing to free. A call that is refused writes nothing:
 a planner that is in that memory stays as it was.

 # Safety
 `memory` must be null or writable for so many bytes, and `given` null or readable for so many samples. The mission's area
 must be null or readable, and so must its chart. The cells of the chart must be readable as long as the planner is used. None of
 them may lie in that memory.
 */
planner_status planner_begin(planner_t **made,
                             void *memory,
                             size_t bytes,
                             const planner_mission *mission,
                             const planner_sample *given,
                             size_t count);

/*
 Plans the next motion from where the robot is. `PLANNER_STATUS_OK`, or why the mission is over.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_plan(planner_t *finder, planner_pose pose, planner_motion *motion);

/*
 Takes in where a motion ended, and what was read there: one of `planner_reading`.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_observe(planner_t *finder, planner_pose pose, int32_t reading);

/*
 As `planner_observe`, of a position that may be off by so many metres, at most by the mission's tolerance. The less it
 may be off, the more the label tells.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_observe_within(planner_t *finder,
                                      planner_pose pose,
                                      int32_t reading,
                                      double tolerance);

/*
 As `planner_observe`, of a label that is right with probability `p`, from 0 to 1. Below 1/2 it rather says the other
 side.

 A mission takes other values than its own `p` if that is below 1 and its tolerance is 0. Where positions err, every
 label counts by the mission's `p`.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_observe_believed(planner_t *finder,
                                        planner_pose pose,
                                        int32_t reading,
                                        double p);

/*
 Takes in what was read at a place on the way, before the motion planned last has ended. The planner keeps a true label
 only if it rules out lines, and leaves the last room for the label at the end. The motion goes on. Tell
 `planner_observe` of its end as without this.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_observe_on_the_way(planner_t *finder,
                                          planner_point at,
                                          int32_t reading);

/*
 The line as far as it is known: the mean of all lines that are left, or in noise of their distribution.
 `PLANNER_STATUS_UNKNOWN` if they lie too close together for single precision.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_estimate(const planner_t *finder,
                                planner_line *line);

/*
 What labels have told of the line so far, bits; not a number without a planner.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
double planner_bits(const planner_t *finder);

/*
 The chance that a label read at a place is +1, errors of the sensor included; from 0 to 1.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_chance(const planner_t *finder, planner_point at, double *chance);

/*
 Writes what a planner has to remember over a sleep. Keep it, and the robot's pose.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_save(const planner_t *finder, planner_snapshot *snapshot);

/*
 Lets a planner go on from where another was, that was begun with the same mission. Begin it first as at the start: what
 it was told since is forgotten, the given samples included. It takes as long as the labels took when they came. A
 planner that refuses a snapshot stays as it was.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_restore(planner_t *finder,
                               const planner_snapshot *snapshot);

/*
 How much memory a planner of fronts takes, bytes.
 */
size_t planner_follower_bytes(void);

/*
 What `planner_follow` will say of a mission, of front settings and of given samples, and which part of them that is
 about. It needs no memory, and touches no planner.

 # Safety
 As for `planner_follow`.
 */
planner_verdict planner_follower_check(const planner_mission *mission,
                                       planner_front_settings front,
                                       const planner_sample *given,
                                       size_t count);

/*
 Makes a planner of fronts in so many bytes of memory that is aligned to 8, from 0 to 16 given samples, and writes where
 it is. It is that memory's beginning: there is nothing to free. Of the mission `slopes` and `level` must be 0. A call
 that is refused writes nothing: a planner that is in that memory stays as it was.

 # Safety
 `memory` must be null or writable for so many bytes, and `given` null or readable for so many samples. The mission's area
 must be null or readable. None of them may lie in that memory.
 */
planner_status planner_follow(planner_follower_t **made,
                              void *memory,
                              size_t bytes,
                              const planner_mission *mission,
                              planner_front_settings front,
                              const planner_sample *given,
                              size_t count);

/*
 Plans the next motion from where the robot is. `PLANNER_STATUS_OK`, or why the mission is over.

 # Safety
 `follower` must be null or from `planner_follow`.
 */
planner_status planner_follower_plan(planner_follower_t *follower,
                                     planner_pose pose,
                                     planner_motion *motion);

/*
 Takes in where a motion ended, and what was read there: one of `planner_reading`.

 # Safety
 `follower` must be null or from `planner_follow`.
 */
planner_status planner_follower_observe(planner_follower_t *follower,
                                        planner_pose pose,
                                        int32_t reading);

/*
 As `planner_follower_observe`, of a position that may be off by so many metres, at most by the mission's tolerance. The
 less it may be off, the more the label tells.

 # Safety
 `follower` must be null or from `planner_follow`.
 */
planner_status planner_follower_observe_within(planner_follower_t *follower,
                                               planner_pose pose,
                                               int32_t reading,
                                               double tolerance);

/*
 Takes in what was read at a place on the way, before the motion planned last has ended. The motion goes on. Tell
 `planner_follower_observe` of its end as without this.

 # Safety
 `follower` must be null or from `planner_follow`.
 */
planner_status planner_follower_observe_on_the_way(planner_follower_t *follower,
                                                   planner_point at,
                                                   int32_t reading);

/*
 The chance that a label read at a place is +1, errors of the sensor included; from 0 to 1. It is 1/2 everywhere as long
 as nothing is known of the front, and it says little of places far from the robot.

 # Safety
 `follower` must be null or from `planner_follow`.
 */
planner_status planner_follower_chance(const planner_follower_t *follower,
                                       planner_point at,
                                       double *chance);

/*
 Where the front is known best. `PLANNER_STATUS_UNKNOWN` as long as it is not found, and where it is lost.

 # Safety
 `follower` must be null or from `planner_follow`.
 */
planner_status planner_front(const planner_follower_t *follower,
                             planner_front_place *front);

/*
 Where the front crosses the line through the pose that is square to its heading. Ask it of places all along a stretch
 that is watched. `PLANNER_STATUS_UNKNOWN` as long as the front is not found, and where it is lost.

 # Safety
 `follower` must be null or from `planner_follow`.
 */
planner_status planner_front_beside(const planner_follower_t *follower,
                                    planner_pose pose,
                                    planner_front_crossing *beside);

/*
 Writes what a planner of fronts has to remember over a sleep, and how many bytes that takes.
 `PLANNER_FOLLOWER_SNAPSHOT_BYTES` are always enough. If there is not so much room, nothing is written: what was saved
 there before stays.

 # Safety
 `follower` must be null or from `planner_follow`, `bytes` null or writable for so many bytes.
 */
planner_status planner_follower_save(const planner_follower_t *follower,
                                     uint8_t *bytes,
                                     size_t room,
                                     size_t *count);

/*
 Lets a planner of fronts go on from where another was, that was begun with the same mission. A planner that refuses
 the bytes stays as it was.

 # Safety
 `follower` must be null or from `planner_follow`, `bytes` null or readable for so many bytes.
 */
planner_status planner_follower_restore(planner_follower_t *follower,
                                        const uint8_t *bytes,
                                        size_t count);

/*
 Whether a status says that the mission has ended. It is a number, as an enumeration of C may hold any.
 */
bool planner_has_ended(int32_t status);

/*
 Whether a status says that a call is refused. Such a call has changed nothing, and the mission can go on.
 */
bool planner_is_refused(int32_t status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PLANNER_H */
