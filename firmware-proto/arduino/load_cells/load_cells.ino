// Four load cells with an HX711 each on an Arduino Uno: a line of four numbers for each measurement, in grams, as
// `tactpad run --pad load-cells:/dev/ttyACM0` reads them: upper left, upper right, lower left, lower right.
//
// All four share one clock, so they are read at the same moment and no library is needed. Wire PD_SCK of all to CLOCK_PIN, each DOUT to
// its DATA_PINS, VCC to 5 V, GND to GND. Tie RATE to VCC: 80 measurements a second, where 10 come without it.
//
// To find COUNTS_PER_G of a cell, put a known weight on its corner: multiply its number here by what the line says over what it weighs.
//
// Protocol: Avia Semiconductor, HX711 data sheet: DOUT falls when a measurement is there; 24 pulses of PD_SCK shift it out, the highest
// bit first, two's complement; a 25th chooses channel A with gain 128 for the next one. A pulse of more than 60 us switches the chip off.

const byte CELLS = 4;
const byte CLOCK_PIN = 2;
const byte DATA_PINS[CELLS] = {3, 4, 5, 6};
const float COUNTS_PER_G[CELLS] = {420.0, 420.0, 420.0, 420.0};

// A cell whose DOUT has not fallen for so long is not there.
const unsigned long WAIT_MS = 300;

void setup() {
  Serial.begin(115200);
  pinMode(CLOCK_PIN, OUTPUT);
  digitalWrite(CLOCK_PIN, LOW);
  for (byte cell = 0; cell < CELLS; cell++) pinMode(DATA_PINS[cell], INPUT_PULLUP);
}

void loop() {
  // Waits for all: cells of one clock are read together.
  const unsigned long begin = millis();
  bool isThere[CELLS];
  bool areAll = false;
  while (!areAll && millis() - begin < WAIT_MS) {
    areAll = true;
    for (byte cell = 0; cell < CELLS; cell++) {
      isThere[cell] = digitalRead(DATA_PINS[cell]) == LOW;
      areAll = areAll && isThere[cell];
    }
  }

  unsigned long bits[CELLS] = {0, 0, 0, 0};
  for (byte pulse = 0; pulse < 25; pulse++) {
    // An interrupt while the clock is high might switch the chips off.
    noInterrupts();
    digitalWrite(CLOCK_PIN, HIGH);
    delayMicroseconds(1);
    digitalWrite(CLOCK_PIN, LOW);
    interrupts();
    if (pulse == 24) break;
    for (byte cell = 0; cell < CELLS; cell++) {
      bits[cell] = bits[cell] << 1 | (digitalRead(DATA_PINS[cell]) == HIGH ? 1UL : 0UL);
    }
  }

  for (byte cell = 0; cell < CELLS; cell++) {
    if (cell > 0) Serial.print(',');
    const bool isAtEnd = bits[cell] == 0x7fffffUL || bits[cell] == 0x800000UL;
    if (!isThere[cell] || isAtEnd) {
      Serial.print("nan");  // tactpad lets go and names the cell.
    } else {
      const long count = bits[cell] & 0x800000UL ? (long)bits[cell] - 0x1000000L : (long)bits[cell];
      Serial.print(count / COUNTS_PER_G[cell], 2);
    }
  }
  Serial.println();
}
