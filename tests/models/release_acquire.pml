/* SPDX-License-Identifier: Apache-2.0 */
/* The memory order of C++, as far as two threads need it to hand data over.
 *
 * A place is memory that is not atomic, e.g. a slot. Two threads may use it in turn only if the second knows what the first
 * did there: an atomic must carry this knowledge, stored by a release and loaded by an acquire. `knows` holds for each
 * thread the places whose last write, and whose last read, the thread knows. Each value of an atomic holds what its writer
 * knew. An access by a thread that lacks this knowledge is a data race, in whatever order the steps run: undefined
 * behaviour, and here a failed assertion.
 *
 * An atomic load may also return an older value than the newest, but none older than the last that its thread has seen.
 * Each model allows this, except for an exchange, which returns the newest.
 *
 * The including model defines PLACES. */
#define WRITER 0
#define READER 1
#define WRITE_OF(place) (1 << (place))
#define READ_OF(place) (1 << (PLACES + (place)))
#define ALL_PLACES ((1 << (2 * PLACES)) - 1)

int knows[2] = ALL_PLACES; /* both threads start after the object is made */

/* The model defines `forget(event)`: after it no atomic carries knowledge of `event`. */
inline touch(thread, place, event) {
  d_step {
    assert((knows[thread] & WRITE_OF(place)) != 0);                          /* else a data race with a write */
    assert(event == READ_OF(place) || (knows[thread] & READ_OF(place)) != 0); /* else a data race with a read */
    knows[WRITER] = knows[WRITER] & ~(event);
    knows[READER] = knows[READER] & ~(event);
    forget(event);
    knows[thread] = knows[thread] | event;
  }
}
