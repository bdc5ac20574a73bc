/* SPDX-License-Identifier: Apache-2.0 */
/* Model of task::TuningBox with two keys. One thread puts VALUES values, each to any key; the other takes.
 *
 * Follows firmware/core/task/tuning_box.hpp. A comment that begins with a colon quotes its text; check.py compares the two.
 * Proved for every order of the steps and every value that C++ lets an atomic return: a value taken was put; a key's values
 * are taken in their order; the last value of each key is taken; neither thread ever waits for the other. All memory is
 * atomic, so there is no data race. Puts of several threads differ only in who puts: fetch_or loses no bit, and a
 * read-modify-write passes on what earlier releases made known. */
#define KEYS 2
#define VALUES 4
#define BIT(key) (1 << (key))

/* Each definition puts one mistake into the code; Spin must find it. */
#ifdef PUT_WITHOUT_RELEASE
#define PUT_RELEASES false
#else
#define PUT_RELEASES true
#endif
#ifdef TAKE_WITHOUT_ACQUIRE
#define TAKE_ACQUIRES false
#else
#define TAKE_ACQUIRES true
#endif
#ifdef TAKE_CLEARS_ALL
#define CLEARED(key) 0
#else
#define CLEARED(key) (waiting & ~BIT(key))
#endif

byte value[KEYS]; /* values_, the newest of each key; a later Put has a larger value */
byte waiting = 0; /* waiting_ */
byte known[KEYS]; /* the values that waiting_ makes known to a thread that acquires it */
bool done = false; /* all were put; read with acquire */

inline set_bit(key) {
  d_step {
    waiting = waiting | BIT(key);
    if
    :: PUT_RELEASES ->
      known[0] = value[0];
      known[1] = value[1]
    :: else
    fi
  }
}

/*: bool Put(const config::Tuning& tuning) noexcept {
      if (tuning.key < 0 || tuning.key >= config::kMostTunable) { return false; } */
inline Put(key, number) {
#ifdef PUT_SETS_THE_BIT_FIRST
  set_bit(key);
  value[key] = number
#else
  /*: values_[static_cast<std::size_t>(tuning.key)].store(tuning.value, std::memory_order_relaxed); */
  value[key] = number;
  /*: waiting_.fetch_or(Bit(tuning.key), std::memory_order_release); return true; } */
  set_bit(key)
#endif
}

/* Takes `key` out of waiting_. `least`: the oldest values that this thread may still read. */
inline clear_bit(key) {
  d_step {
    waiting = CLEARED(key);
    own = waiting;
    if
    :: TAKE_ACQUIRES ->
      least[0] = (known[0] > least[0] -> known[0] : least[0]);
      least[1] = (known[1] > least[1] -> known[1] : least[1])
    :: else
    fi
  }
}

/* Any value from the newest that this thread has seen to the newest of all. */
inline load_value(key) {
  do
  :: least[key] < value[key] -> least[key]++
  :: break
  od;
  number = least[key]
}

/*: config::Tuning Take() noexcept { */
inline Take(key, number, came) {
  /*: const std::uint32_t waiting = waiting_.load(std::memory_order_relaxed); */
  /* At least the bits that this thread left there; all bits once it knows that the Puts are done. */
  seen = own;
  if
  :: (waiting & BIT(0)) -> seen = seen | BIT(0)
  :: !knows_done || !(waiting & BIT(0))
  fi;
  if
  :: (waiting & BIT(1)) -> seen = seen | BIT(1)
  :: !knows_done || !(waiting & BIT(1))
  fi;
  /*: if (waiting == 0) { return {}; } */
  if
  :: seen == 0 -> came = false
  :: else ->
    /*: const std::uint32_t ahead = waiting & ~(Bit(turn_) - 1U);
        const int key = std::countr_zero(ahead != 0 ? ahead : waiting); */
    if
    :: (seen & BIT(turn)) -> key = turn
    :: else -> key = 1 - turn
    fi;
    /*: turn_ = (key + 1) % config::kMostTunable; */
    turn = (key + 1) % KEYS;
#ifdef TAKE_CLEARS_LAST
    load_value(key);
    clear_bit(key);
#else
    /*: waiting_.fetch_and(~Bit(key), std::memory_order_acquire); */
    clear_bit(key);
    /*: return {key, values_[static_cast<std::size_t>(key)].load(std::memory_order_relaxed)}; } */
    load_value(key);
#endif
    came = true
  fi
}

active proctype Operator() {
  byte number = 1;
  do
  :: number <= VALUES ->
    if
    :: Put(0, number)
    :: Put(1, number)
    fi;
    number++
  :: else -> break
  od;
  done = true
}

active proctype Servo() {
  byte least[KEYS];
  byte last[KEYS];
  byte key = 0, number = 0, turn = 0, seen = 0, own = 0;
  bool came = false, knows_done = false;
  do
  :: knows_done = done;
    if
    :: knows_done ->
      least[0] = value[0];
      least[1] = value[1]
    :: else
    fi;
    Take(key, number, came);
    if
    :: came ->
      assert(number > 0);          /* it was put */
      assert(number >= last[key]); /* never an older one */
      last[key] = number
    :: else
    fi;
    if
    :: knows_done && !came -> break
    :: else
    fi
  od;
  assert(last[0] == value[0] && last[1] == value[1]) /* the last value of each key is never lost */
}
