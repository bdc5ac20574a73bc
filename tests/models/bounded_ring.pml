/* SPDX-License-Identifier: Apache-2.0 */
/* Model of linux_rt::BoundedRing, used by the recorder and the log. One thread pushes VALUES values, the other drains.
 *
 * Follows hal/drivers/linux_rt/include/fovea/linux_rt/bounded_ring.hpp. A comment that begins with a colon quotes its text;
 * check.py compares the two. Proved for every order of the steps and every value that C++ lets an atomic return: no thread
 * uses a place that the other may be using; values arrive whole, each once, in the order of the pushes; every value is
 * either taken or counted as dropped; a Push drops nothing if HasRoom was true before it; neither thread waits for the
 * other. */
#define CAPACITY 2
#define VALUES 5
#define PLACES CAPACITY
#include "release_acquire.pml"

/* Each definition puts one mistake into the code; Spin must find it. */
#ifdef WRITTEN_WITHOUT_RELEASE
#define WRITTEN_RELEASES 0
#else
#define WRITTEN_RELEASES 1
#endif
#ifdef READ_WITHOUT_RELEASE
#define READ_RELEASES 0
#else
#define READ_RELEASES 1
#endif
#ifdef ROOM_WITHOUT_ACQUIRE
#define ROOM_ACQUIRES 0
#else
#define ROOM_ACQUIRES 1
#endif
#ifdef END_WITHOUT_ACQUIRE
#define END_ACQUIRES 0
#else
#define END_ACQUIRES 1
#endif
#ifdef ONE_TOO_MANY
#define LESS <=
#else
#define LESS <
#endif

byte first_half[CAPACITY]; /* values_ in two halves, so that a half-written value shows */
byte second_half[CAPACITY];
byte written = 0; /* written_: the newest value */
byte read = 0;    /* read_ */
byte dropped = 0; /* dropped_ */
/* What each value of written_ and of read_ makes known to its reader. */
int written_knows[VALUES + 1] = ALL_PLACES;
int read_knows[VALUES + 1] = ALL_PLACES;

byte pushed[VALUES]; /* the values that were stored, in order */
bool done = false;   /* all were pushed; read with acquire */

byte forgetting = 0;
inline forget(event) {
  do
  :: forgetting <= VALUES ->
    written_knows[forgetting] = written_knows[forgetting] & ~(event);
    read_knows[forgetting] = read_knows[forgetting] & ~(event);
    forgetting++
  :: else -> break
  od;
  forgetting = 0
}

inline store_written(value) {
  d_step {
    written = value;
    written_knows[written] = (WRITTEN_RELEASES -> knows[WRITER] : 0)
  }
}
inline store_read(value) {
  d_step {
    read = value;
    read_knows[read] = (READ_RELEASES -> knows[READER] : 0)
  }
}

/* Returns any value from the newest that this thread has seen to the newest of all. */
inline load_written(acquires) {
  do
  :: seen_written < written -> seen_written++
  :: break
  od;
  knows[READER] = knows[READER] | (acquires -> written_knows[seen_written] : 0)
}
inline load_read(acquires) {
  do
  :: seen_read < read -> seen_read++
  :: break
  od;
  knows[WRITER] = knows[WRITER] | (acquires -> read_knows[seen_read] : 0)
}

/*: [[nodiscard]] bool HasRoom() const noexcept { */
inline HasRoom(has_room) {
  /*: return written_.load(std::memory_order_relaxed) - read_.load(std::memory_order_acquire) < values_.size(); } */
  /* */
  /* Nobody else writes written_. */
  load_read(ROOM_ACQUIRES);
  has_room = (written - seen_read LESS CAPACITY)
}

/*: void Push(const T& value) noexcept { Fill([&value](T& place) { place = value; }); } */
/*: void Fill(const Make& fill) noexcept { */
inline Push(value) {
  /*: const std::uint64_t at = written_.load(std::memory_order_relaxed); */
  at = written;
  /*: if (!HasRoom()) { */
  HasRoom(has_room);
  if
  :: !has_room ->
    assert(!promised);
    /*: dropped_.fetch_add(1, std::memory_order_relaxed); return; } */
    dropped++
  :: has_room ->
    pushed[at] = value;
#ifdef WRITTEN_TOO_EARLY
    store_written(at + 1);
#endif
    /*: fill(values_[at % values_.size()]); */
    touch(WRITER, at % CAPACITY, WRITE_OF(at % CAPACITY));
    first_half[at % CAPACITY] = value;
    second_half[at % CAPACITY] = value;
    /*: written_.store(at + 1, std::memory_order_release); } */
#ifndef WRITTEN_TOO_EARLY
    store_written(at + 1)
#endif
  fi
}

/*: [[nodiscard]] std::uint64_t End() const noexcept { return written_.load(std::memory_order_acquire); } */
inline End(end) {
  load_written(END_ACQUIRES);
  end = seen_written
}

/*: struct Taken { std::atomic<std::uint64_t>& read; std::uint64_t next;
      ~Taken() { read.store(next, std::memory_order_release); } }; */
/*: std::size_t Drain(std::uint64_t end, Take&& take) { */
inline Drain(end) {
  /*: const std::uint64_t begin = read_.load(std::memory_order_relaxed);
      for (std::uint64_t next = begin; next != end; ++next) { const Taken taken{read_, next + 1}; */
  /* Nobody else writes read_. */
  next = read;
  do
  :: next != end ->
#ifdef READ_TOO_EARLY
    store_read(next + 1);
#endif
    /*: take(values_[next % values_.size()]); } */
    touch(READER, next % CAPACITY, READ_OF(next % CAPACITY));
    value = first_half[next % CAPACITY];
    assert(second_half[next % CAPACITY] == value); /* whole */
    assert(value == pushed[next]);                 /* each once, in order */
    /* Taken's destructor. */
#ifndef READ_TOO_EARLY
    store_read(next + 1);
#endif
    next++
  :: else -> break
  od
  /*: return end - begin; } */
}

active proctype Servo() {
  byte value = 0, at = 0, seen_read = 0;
  bool has_room = false, promised = false;
  do
  :: value < VALUES ->
    if /* RunLog first asks HasRoom when nothing may be dropped */
    :: HasRoom(promised)
    :: skip
    fi;
    Push(value + 1);
    promised = false;
    value++
  :: else -> break
  od;
  done = true
}

active proctype Log() {
  byte value = 0, next = 0, end = 0, seen_written = 0;
  bool knows_done = false;
  do
  :: knows_done = done;
    if
    :: knows_done -> seen_written = written
    :: else
    fi;
    End(end);
    Drain(end);
    if
    :: knows_done -> break
    :: else
    fi
  od;
  assert(next + dropped == VALUES) /* nothing is lost silently */
}
