/* The hand-over between reader, filter and housekeeping, as daemon/pipeline has it: ring.h, increment_queue.cpp, wakeup.cpp,
 * hand_over.cpp, filter_stage.cpp (run, ask, take_snapshot), checked by Spin over every order of events.
 *
 *   reader        next / push / flush / flush_or_borrow + give_back / close
 *   filter        step, answer, finished, wait
 *   housekeeping  ask, notify, take_snapshot, and the last word once the filter has ended
 *
 * Checked: every sample reaches the consumer once and in order, merged or not, also when no other follows it; one consumer at a
 * time; nobody sleeps for ever (an end state that is not the end of all three is an error); every question is answered; the
 * last word tells of the last sample.
 *
 * A model of sequentially consistent memory. Within it each step that touches what two threads share is one atomic step
 * of its own, as the hardware's are: a read and a write are joined only where the code has a read-modify-write.
 *
 * -DRING=n slots, -DSAMPLES=n. -DMUTANT_x takes one precaution away; tests/hand_over/run expects Spin to find fault with each.
 */

#ifndef RING
#define RING 2
#endif
#ifndef SAMPLES
#define SAMPLES 4
#endif
#ifndef ASKS
#define ASKS 2
#endif

#define AWAKE 0
#define ASLEEP 1
#define LENT 2
#define LENT_CALLED 3

#define NONE 0
#define ASKED 1
#define ANSWERED 2

/* The ring: samples first..last of each slot. */
byte first[RING], last[RING];
byte head, tail;

/* What waits outside a full ring; the reader's own. */
bool has_waiting;
byte waiting_first, waiting_last;

/* Wakeup: the word. FUTEX_WAKE needs no step of its own: a sleeper that is woken looks at the word. */
byte word = AWAKE;
bool closed, nudged;

/* The consumer's: whichever thread it is. */
byte consumers, expected = 1;

/* The snapshot. */
byte ask = NONE;
byte snapshot, known;
bool filter_ended, reader_ended;

/* Wakeup::notify: fetch_or, then a compare-and-swap from what was seen, over again if it failed. */
inline notify(seen) {
  do
  :: atomic { seen = word };
     if
     :: seen == ASLEEP ->
        atomic { if :: word == ASLEEP -> word = AWAKE; seen = 9 :: else -> skip fi };
        if :: seen == 9 -> break :: else -> skip fi
     :: seen == LENT ->
#ifdef MUTANT_CALL_FORGOTTEN
        break
#else
        atomic { if :: word == LENT -> word = LENT_CALLED; seen = 9 :: else -> skip fi };
        if :: seen == 9 -> break :: else -> skip fi
#endif
     :: else -> break
     fi
  od
}

inline place_waiting(placed) {
  placed = false;
  if
  :: atomic { head - tail < RING ->
       first[head % RING] = waiting_first;
       last[head % RING] = waiting_last;
       waiting_first = 0;
       waiting_last = 0;
       has_waiting = false;
       placed = true }
     head++
  :: else -> skip
  fi
}

/* FilterStage::step; the caller is the consumer. */
inline step(stepped, f, l) {
  stepped = false;
  if
  :: atomic { head != tail;
       f = first[tail % RING];
       l = last[tail % RING];
       assert(f == expected);  /* none lost, doubled or out of order */
       assert(l >= f);
       expected = l + 1;
       stepped = true }
     atomic { tail++; f = 0; l = 0 }
  :: else -> skip
  fi
}

/* HandOver::delivered(). */
inline delivered() {
  if :: has_waiting -> place_waiting(ok) :: else -> skip fi;
  borrowed = false;
  if
  :: skip ->  /* flush_or_borrow */
     seen = word;
#ifdef MUTANT_BORROWS_BY_WRITING
     if :: seen == ASLEEP -> word = LENT; borrowed = true :: else -> skip fi
#else
     atomic { if :: seen == ASLEEP && word == ASLEEP -> word = LENT; borrowed = true :: else -> skip fi }
#endif
  :: skip  /* flush: the filter thread has been found too slow, or too many wait */
  fi;
  if
  :: borrowed ->
     consumers++; assert(consumers == 1);
     do
     :: step(ok, f, l); if :: ok -> skip :: else -> break fi
     od;
     consumers--;
     /* give_back(ring.size() > 0) */
     ok = head != tail;
     seen = 0;
     atomic { if :: !ok && word == LENT -> word = ASLEEP; seen = 9 :: else -> skip fi };
#ifdef MUTANT_GIVES_BACK_ASLEEP
     if :: seen != 9 -> word = ASLEEP :: else -> skip fi
#else
     if :: seen != 9 -> word = AWAKE :: else -> skip fi
#endif
  :: else ->
#ifdef MUTANT_NO_WAKE
     skip
#else
     notify(seen)
#endif
  fi
}

proctype reader() {
  byte sample = 1, seen, f, l, spare;
  bool ok, borrowed;
  do
  :: sample <= SAMPLES ->
     /* Any number of samples a delivery. */
     do
     :: sample <= SAMPLES ->
        /* next() and push() */
        ok = false;
        if
        :: has_waiting ->
#ifdef MUTANT_OVERTAKES
           ok = head - tail < RING
#else
           place_waiting(ok);
           if :: ok -> ok = head - tail < RING :: else -> skip fi
#endif
        :: else -> ok = head - tail < RING
        fi;
        if
        :: ok ->
#ifdef MUTANT_COMMITTED_EARLY
           head++;
           first[(head - 1) % RING] = sample;
           last[(head - 1) % RING] = sample
#else
           atomic { first[head % RING] = sample; last[head % RING] = sample };
           head++
#endif
        :: atomic { !ok && has_waiting -> assert(waiting_last + 1 == sample); waiting_last = sample }
        :: atomic { !ok && !has_waiting -> waiting_first = sample; waiting_last = sample; has_waiting = true }
        fi;
        sample++
     :: break
     od;
     delivered();
     if
     :: skip  /* more comes at once */
     :: skip ->
        /* The source falls silent; Reader::run still takes empty turns while something waits outside the ring. Then all
         * that was sent must come through, and every question be answered, before anything else happens. */
        do
        :: has_waiting -> delivered()
        :: else -> break
        od;
        expected == sample && ask != ASKED
     fi
  :: else -> break
  od;
  /* close() */
  do
  :: has_waiting -> place_waiting(ok); if :: ok -> skip :: else -> notify(seen); (head - tail < RING) fi
  :: else -> break
  od;
  closed = true;
  notify(seen);
  reader_ended = true
}

proctype filter() {
  byte seen, f, l;
  bool ok, ready;
  consumers++;
  do
  :: assert(consumers == 1);
     step(ok, f, l);
     if
     :: ask == ASKED -> snapshot = expected - 1; ask = ANSWERED
     :: else -> skip
     fi;
     if
     :: ok -> skip
     :: else ->
        /* finished(): closed first, then the ring */
        ready = closed;
        if
        :: ready && head == tail -> break
        :: else ->
           /* wait(): announce, look once more, sleep */
           consumers--;
#ifdef MUTANT_LOOKS_BEFORE_ANNOUNCING
           ready = head != tail || closed || nudged;
           nudged = false;
           word = ASLEEP;
#else
           word = ASLEEP;
           ready = head != tail;
           if :: !ready -> ready = closed :: else -> skip fi;
           if :: !ready -> atomic { ready = nudged; nudged = false } :: else -> skip fi;
#endif
           if :: ready -> notify(seen) :: else -> skip fi;
           word == AWAKE;  /* sleep(): the futex's own compare and sleep are one step */
           consumers++;
           nudged = false
        fi
     fi
  od;
  consumers--;
#ifdef MUTANT_LAST_WORD_BY_FILTER
  if :: ask != ANSWERED -> snapshot = expected - 1; ask = ANSWERED :: else -> skip fi;
#endif
  filter_ended = true
}

proctype housekeeping() {
  byte seen, asks;
  do
  :: asks < ASKS ->
     asks++;
     /* ask() */
     if
     :: atomic { ask == NONE -> ask = ASKED }; nudged = true; notify(seen)
     :: else -> skip
     fi;
     /* take_snapshot(), or later */
     if
     :: ask == ANSWERED -> known = snapshot; ask = NONE
     :: skip
     fi
  :: break
  od;
  /* The last word: when both threads are done, whoever asks writes it. */
  filter_ended && reader_ended;
#ifdef MUTANT_LAST_WORD_BY_FILTER
  if :: ask == ANSWERED -> known = snapshot; ask = NONE :: else -> skip fi;
#else
  known = expected - 1;
#endif
  assert(known == SAMPLES)
}

init { atomic { run reader(); run filter(); run housekeeping() } }
