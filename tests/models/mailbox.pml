/* SPDX-License-Identifier: Apache-2.0 */
/* Model of hal::Mailbox: three slots, one atomic. One thread puts VALUES messages, the other takes.
 *
 * Follows hal/include/fovea/hal/mailbox.hpp. A comment that begins with a colon quotes its text; check.py compares the two. Proved for
 * every order of the steps and every value that C++ lets an atomic return: no thread uses a slot that the other may be
 * using; a message taken is whole, newer than the one before, and at least as new as the newest when the Take began;
 * the last message put is taken; neither thread ever waits for the other. */
#define VALUES 5
#define PLACES 3
#include "release_acquire.pml"

/* Each definition puts one mistake into the code; Spin must find it. */
#ifdef PUT_WITHOUT_RELEASE
#define PUT_RELEASES 0
#else
#define PUT_RELEASES 1
#endif
#ifdef PUT_WITHOUT_ACQUIRE
#define PUT_ACQUIRES 0
#else
#define PUT_ACQUIRES 1
#endif
#ifdef TAKE_WITHOUT_RELEASE
#define TAKE_RELEASES 0
#else
#define TAKE_RELEASES 1
#endif
#ifdef TAKE_WITHOUT_ACQUIRE
#define TAKE_ACQUIRES 0
#else
#define TAKE_ACQUIRES 1
#endif

byte first_half[3]; /* slots_ in two halves, so that a half-written message shows */
byte second_half[3];
byte write_slot = 0;
byte middle_slot = 1; /* middle_ & kSlotMask */
bool middle_fresh = false; /* middle_ & kFresh */
int middle_knows = ALL_PLACES;
byte read_slot = 2;

byte newest = 0;   /* the last message whose Put has ended */
bool done = false; /* all were put; read with acquire */

inline forget(event) {
  middle_knows = middle_knows & ~(event)
}

/* middle_.exchange(slot | fresh): returns the newest value. Like every read-modify-write it passes on what earlier
 * releases made known. */
inline exchange(thread, slot, fresh, releases, acquires, returned) {
  d_step {
    returned = middle_slot;
    middle_slot = slot;
    middle_fresh = fresh;
    carry = (acquires -> middle_knows : 0);
    middle_knows = middle_knows | (releases -> knows[thread] : 0);
    knows[thread] = knows[thread] | carry;
    carry = 0
  }
}

/*: void Put(const Message& message) noexcept { */
inline Put(message) {
  /*: slots_[write_slot_] = message; */
  touch(WRITER, write_slot, WRITE_OF(write_slot));
  first_half[write_slot] = message;
  second_half[write_slot] = message;
  /*: const auto offered = static_cast<std::uint8_t>(write_slot_ | kFresh);
      const std::uint8_t returned = middle_.exchange(offered, std::memory_order_acq_rel); */
  exchange(WRITER, write_slot, true, PUT_RELEASES, PUT_ACQUIRES, returned);
  /*: write_slot_ = returned & kSlotMask; } */
#ifndef WRITER_KEEPS_ITS_SLOT
  write_slot = returned;
#endif
  returned = 0
}

/*: bool Take(Message& message) noexcept { */
inline Take(message, came) {
  /*: if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) { return false; } */
  /* A reader that knows all Puts are done sees the newest value. Before, it may still see its own last exchange. */
  if
#ifndef TAKE_WITHOUT_LOOKING
  :: !middle_fresh -> came = false
  :: middle_fresh && !knows_done -> came = false
  :: middle_fresh -> came = true
#else
  :: came = true
#endif
  fi;
  if
  :: !came
  :: came ->
    /*: const std::uint8_t taken = middle_.exchange(read_slot_, std::memory_order_acq_rel); */
    exchange(READER, read_slot, false, TAKE_RELEASES, TAKE_ACQUIRES, taken);
    /*: read_slot_ = taken & kSlotMask; */
    read_slot = taken;
    taken = 0;
    /*: message = slots_[read_slot_]; */
    touch(READER, read_slot, READ_OF(read_slot));
    message = first_half[read_slot];
    assert(second_half[read_slot] == message) /* whole */
    /*: return true; } */
  fi
}

active proctype Vision() {
  byte value = 1, returned = 0;
  int carry = 0;
  do
  :: value <= VALUES ->
    Put(value);
    d_step { newest = value; value++ }
  :: else -> break
  od;
  done = true
}

active proctype Servo() {
  byte last = 0, message = 0, at_least = 0, taken = 0;
  int carry = 0;
  bool came = false, knows_done = false;
  do
  :: knows_done = done;
    at_least = newest;
    Take(message, came);
    if
    :: came ->
      assert(message > last);      /* never an older one */
      assert(message >= at_least); /* the newest wins */
      last = message;
      came = false;
      message = 0
    :: else
    fi;
    at_least = 0;
    if
    :: knows_done -> break
    :: else
    fi
  od;
  assert(last == VALUES) /* the last one is never lost */
}
