/* SPDX-License-Identifier: Apache-2.0 */
/* Model of cortex_m7::ByteRing, between an interrupt and the main program. One side puts VALUES bytes, the other takes.
 *
 * Follows hal/drivers/cortex_m7/include/fovea/cortex_m7/byte_ring.hpp. A comment that begins with a colon quotes its text;
 * check.py compares the two. The counters wrap, here at WRAP instead of 2^32. Proved for every order of the steps and every
 * value that C++ lets an atomic return: no side uses a byte that the other may be using; bytes arrive each once, in order,
 * across the wrap; a refused byte is not stored; Put succeeds if Room was not 0; Take succeeds if Empty was false; neither
 * side ever waits. */
#ifdef CAPACITY_NO_POWER_OF_TWO
#define CAPACITY 3
#else
#define CAPACITY 2
#endif
#define WRAP 4
#define VALUES 6
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
#ifdef TAKE_WITHOUT_ACQUIRE
#define TAKE_ACQUIRES 0
#else
#define TAKE_ACQUIRES 1
#endif
#ifdef COMPARED_BEFORE_THE_WRAP
#define ROOM(written, read) (CAPACITY - (written - read))
#else
#define ROOM(written, read) (CAPACITY - (written + WRAP - read) % WRAP)
#endif

byte bytes[CAPACITY]; /* bytes_ */
/* Number of stores to written_ and to read_; modulo WRAP it is their newest value. */
byte written = 0;
byte read = 0;
/* What each value of written_ and of read_ makes known to its reader. */
int written_knows[VALUES + 1] = ALL_PLACES;
int read_knows[VALUES + 1] = ALL_PLACES;

byte put[VALUES]; /* the bytes that were stored, in order */
byte refused = 0;
bool done = false; /* all were put; read with acquire */

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

/*: [[nodiscard]] std::size_t Room() const noexcept { */
inline Room(room) {
  /*: return kCapacity - (written_.load(std::memory_order_relaxed) - read_.load(std::memory_order_acquire)); } */
  /* */
  /* Nobody else writes written_. */
  load_read(ROOM_ACQUIRES);
  room = ROOM(written % WRAP, seen_read % WRAP)
}

/*: bool Put(std::uint8_t byte) noexcept { */
inline Put(value) {
  /*: if (Room() == 0) { return false; } */
  Room(room);
  if
  :: room == 0 ->
    assert(promised == 0);
    refused++
  :: else ->
    /*: const std::uint32_t at = written_.load(std::memory_order_relaxed); */
    at = written % WRAP;
    put[written] = value;
    /*: bytes_[at % kCapacity] = byte; */
    touch(WRITER, at % CAPACITY, WRITE_OF(at % CAPACITY));
    bytes[at % CAPACITY] = value;
    /*: written_.store(at + 1, std::memory_order_release); return true; } */
    store_written(written + 1)
  fi
}

/*: [[nodiscard]] bool Empty() const noexcept { */
inline Empty(is_empty) {
  /*: return read_.load(std::memory_order_relaxed) == written_.load(std::memory_order_acquire); } */
  /* */
  /* Nobody else writes read_. */
  load_written(TAKE_ACQUIRES);
  is_empty = (read % WRAP == seen_written % WRAP)
}

/*: bool Take(std::uint8_t& byte) noexcept { */
inline Take(value, came) {
  /*: const std::uint32_t at = read_.load(std::memory_order_relaxed); */
  at = read % WRAP;
  /*: if (at == written_.load(std::memory_order_acquire)) { return false; } */
  load_written(TAKE_ACQUIRES);
  if
  :: at == seen_written % WRAP -> came = false
  :: else ->
    /*: byte = bytes_[at % kCapacity]; */
    touch(READER, at % CAPACITY, READ_OF(at % CAPACITY));
    value = bytes[at % CAPACITY];
    /*: read_.store(at + 1, std::memory_order_release); return true; } */
    store_read(read + 1);
    came = true
  fi
}

active proctype Interrupt() {
  byte value = 0, at = 0, seen_read = 0;
  short room = 0, promised = 0;
  do
  :: value < VALUES ->
    if /* SendBytes first asks Room whether a whole message fits */
    :: Room(promised)
    :: skip
    fi;
    Put(value + 1);
    promised = 0;
    value++
  :: else -> break
  od;
  done = true
}

active proctype Program() {
  byte value = 0, at = 0, seen_written = 0, taken = 0;
  bool came = false, is_empty = false, knows_done = false;
  do
  :: knows_done = done;
    if
    :: knows_done -> seen_written = written
    :: else
    fi;
    Empty(is_empty);
    Take(value, came);
    assert(is_empty || came); /* a ring that is not empty gives a byte */
    if
    :: came ->
      assert(value == put[taken]); /* each once, in order */
      taken++
    :: else
    fi;
    value = 0;
    if
    :: knows_done && !came -> break
    :: else
    fi
  od;
  assert(taken + refused == VALUES) /* nothing is lost silently */
}
