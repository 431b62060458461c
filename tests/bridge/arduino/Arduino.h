// As much of an Arduino Uno as the sketch uses, with four HX711 by their data sheet at its pins. Time is what the sketch's own calls take.
//
// Standard input has a line for each measurement: four counts, or `-` for a chip that is not there.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

typedef unsigned char byte;
enum { LOW, HIGH };
enum { INPUT, OUTPUT, INPUT_PULLUP };

// One chip: shifts out at rising edges of the clock, and is busy from the 25th on.
struct Chip {
  bool isThere = false;
  unsigned long bits = 0;
  int shifted = 0;
  bool dout = true;
};

struct Board {
  Chip chips[4];
  unsigned long us = 0;
  unsigned long readyUs = 0;
  unsigned long riseUs = 0;
  bool clock = false;
  bool mayInterrupt = true;
  bool isMeasured = false;
  int pulses = 0;

  // The next measurement, 12.5 ms after the one before.
  void measure() {
    if (isMeasured || us < readyUs) return;
    char words[4][32];
    if (scanf("%31s %31s %31s %31s", words[0], words[1], words[2], words[3]) != 4) exit(0);
    for (int cell = 0; cell < 4; cell++) {
      const bool isThere = strcmp(words[cell], "-") != 0;
      chips[cell].isThere = isThere;
      chips[cell].bits = isThere ? (unsigned long)strtol(words[cell], nullptr, 10) & 0xffffffUL : 0;
      chips[cell].shifted = 0;
      chips[cell].dout = !isThere;
    }
    isMeasured = true;
  }

  void edge(bool isHigh) {
    if (isHigh == clock) return;
    clock = isHigh;
    if (!isHigh) {
      if (us - riseUs > 60) { fprintf(stderr, "the clock was high for %lu us\n", us - riseUs); exit(1); }
      return;
    }
    if (mayInterrupt) { fprintf(stderr, "an interrupt may come while the clock is high\n"); exit(1); }
    riseUs = us;
    for (Chip &chip : chips) {
      if (!chip.isThere) continue;
      chip.dout = chip.shifted < 24 ? (chip.bits >> (23 - chip.shifted) & 1UL) != 0 : true;
      if (++chip.shifted > 25) { fprintf(stderr, "more than 25 pulses choose another channel\n"); exit(1); }
    }
    if (++pulses == 25) {
      pulses = 0;
      isMeasured = false;
      readyUs = us + 12500;
    }
  }
};

static Board board;

// A call takes some four microseconds on an Uno.
static void pass(unsigned long us) { board.us += us; }
inline void pinMode(byte, byte) {}
inline void digitalWrite(byte, byte level) { pass(4); board.edge(level == HIGH); }
inline int digitalRead(byte pin) { pass(4); board.measure(); return board.chips[pin - 3].dout ? HIGH : LOW; }
inline unsigned long millis() { pass(1); board.measure(); return board.us / 1000; }
inline void delayMicroseconds(unsigned us) { pass(us); }
inline void noInterrupts() { board.mayInterrupt = false; }
inline void interrupts() { board.mayInterrupt = true; }

// Prints a float as Arduino's Print does: rounded, with so many digits behind the point.
struct Port {
  void begin(long) {}
  void print(char letter) { putchar(letter); }
  void print(const char *text) { fputs(text, stdout); }
  void print(double value, int digits) { printf("%.*f", digits, value); }
  void println() { fputs("\r\n", stdout); }
};

static Port Serial;

void setup();
void loop();

int main() {
  setup();
  for (;;) loop();
}
