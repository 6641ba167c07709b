/* A planner that finds a straight boundary from few samples. Made from planner-core/c/src: change it there. */

#ifndef PLANNER_H
#define PLANNER_H



#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 What a call came to.
 */
typedef enum {
  /*
   It was done.
   */
  PLANNER_STATUS_OK,
  /*
   Stopped: the line is known as well as was asked for.
   */
  PLANNER_STATUS_KNOWN,
  /*
   Stopped: no motion leads to uncertain ground, as what is left of it is too thin or out of reach.
   */
  PLANNER_STATUS_RESOLUTION,
  /*
   Stopped: there is no room for another sample.
   */
  PLANNER_STATUS_FULL,
  /*
   Stopped: outside the area, or cornered.
   */
  PLANNER_STATUS_STUCK,
  /*
   Refused: the reading contradicts what is certain.
   */
  PLANNER_STATUS_CONTRADICTION,
  /*
   Refused: a pointer is null, or the memory too small or not aligned to 8 bytes.
   */
  PLANNER_STATUS_MEMORY,
  /*
   Refused: a number of the mission is out of its range.
   */
  PLANNER_STATUS_MISSION,
  /*
   Refused: a position is further than 8,192 m from the origin, or no number.
   */
  PLANNER_STATUS_POSITION,
  /*
   Refused: there is no such reading.
   */
  PLANNER_STATUS_READING,
  /*
   Refused: no line separates the given samples, or they are collinear, too many or of one label, or one says
   something else than 0 or 1 for whether it is positive.
   */
  PLANNER_STATUS_GIVEN,
  /*
   Stopped: there is uncertain ground, but none of the ways that a plan tries leads there. From another pose one may.
   */
  PLANNER_STATUS_UNDECIDED,
  /*
   Refused: the tolerance leaves nothing of the area, as no place is as far from its border.
   */
  PLANNER_STATUS_TOLERANCE_TOO_LARGE,
  /*
   Stopped: what is uncertain is so thin that no label can tell more, as positions err.
   */
  PLANNER_STATUS_IMPRECISE,
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
   How often a label is right: 1 if always, else above 1/2.
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
} planner_mission;

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

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 How much memory the planner of a mission takes, bytes; 0 if there is no such mission.
 */
size_t planner_bytes(const planner_mission *mission);

/*
 Makes a planner in so many bytes of memory that is aligned to 8, from 3 to 16 given samples of both labels, and
 writes where it is. It is that memory's beginning: there is nothing to free. A call that is refused writes nothing:
 a planner that is in that memory stays as it was.

 # Safety
 `memory` must be null or writable for so many bytes, `given` null or readable for so many samples, and none of them
 in that memory.
 */
planner_status planner_begin(planner_t **made,
                             void *memory,
                             size_t bytes,
                             const planner_mission *mission,
                             const planner_sample *given,
                             size_t count);

/*
 Plans the next motion from where the robot is. `Ok`, or why the mission is over.

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
 The line as far as it is known: the mean of all lines that are left, or in noise of their distribution.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
planner_status planner_estimate(planner_t *finder,
                                planner_line *line);

/*
 What labels have told of the line so far, bits; not a number without a planner.

 # Safety
 `finder` must be null or from `planner_begin`.
 */
double planner_bits(planner_t *finder);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PLANNER_H */
