/* C++'s memory order, as far as two threads that hand something over need it.
 *
 * A place is memory that is no atomic, e.g. a slot. Two threads may take turns at it only where the second knows of what
 * the first did: where an atomic carried the knowledge, put there by a release and picked up by an acquire. `knows` has for
 * each thread the places of whose last write, and of whose last read, it knows; an atomic's value has the same of what its
 * writer knew. An access by a thread that does not know is a data race, whatever the order in which things happen to come:
 * undefined behaviour, and here an assertion that does not hold.
 *
 * An atomic read may also give an older value than the newest, down to the one that its thread has seen before; each model
 * lets it, where the value is not read by an exchange, which takes the newest.
 *
 * The including model defines PLACES. */
#define WRITER 0
#define READER 1
#define WRITE_OF(place) (1 << (place))
#define READ_OF(place) (1 << (PLACES + (place)))
#define ALL_PLACES ((1 << (2 * PLACES)) - 1)

int knows[2] = ALL_PLACES; /* whoever made the object had both threads started after it */

/* `forget(event)` is the model's: no atomic carries knowledge of `event` any more. */
inline touch(thread, place, event) {
  d_step {
    assert((knows[thread] & WRITE_OF(place)) != 0);                          /* else a data race: with a write */
    assert(event == READ_OF(place) || (knows[thread] & READ_OF(place)) != 0); /* else a data race: with a read */
    knows[WRITER] = knows[WRITER] & ~(event);
    knows[READER] = knows[READER] & ~(event);
    forget(event);
    knows[thread] = knows[thread] | event;
  }
}
