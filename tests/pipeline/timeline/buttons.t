# A short press taps when it ends, a long one holds from long_press_ms on.

case a press at the threshold taps when it falls below the release force
profile super-mario

0ms fz=1.999
1ms fz=2.0
50ms fz=1.401
100ms fz=1.399
101ms fz=1.399

100ms BTN_SOUTH 1
101ms BTN_SOUTH 0

case just below the threshold nothing is pressed
profile super-mario

0ms..500ms fz=1.999
501ms lift

nothing

case 399 ms is short
profile super-mario

0ms fz=2
399ms fz=2
399ms fz=1
400ms fz=1

399ms BTN_SOUTH 1
400ms BTN_SOUTH 0

case 400 ms is long: it holds and never taps
profile super-mario

1000ms fz=2
1399ms fz=2
1400ms fz=2
1700ms fz=1.4
1701ms fz=1.39
1702ms lift

1400ms BTN_EAST 1
1701ms BTN_EAST 0

case a lift ends a press and taps
profile super-mario
output keyboard

0ms fz=3
120ms lift
121ms lift

120ms KEY_Z 1
121ms KEY_Z 0

case a lift ends a long press
profile super-mario
output keyboard

0ms..450ms fz=3
451ms lift

400ms KEY_X 1
451ms KEY_X 0

case a long press that ends before the next sample still states its output once
profile super-mario

0ms fz=3
399ms fz=3
401ms lift
402ms lift

401ms BTN_EAST 1
402ms BTN_EAST 0

case a press that dips to the release force goes on
profile super-mario

0ms..200ms fz=2.5
201ms fz=1.4
202ms..399ms fz=1.9
400ms fz=1.5
401ms lift

400ms BTN_EAST 1
401ms BTN_EAST 0

case two presses tap twice
profile super-mario

0ms fz=2.5
50ms fz=0.5
51ms fz=0.5
100ms fz=2.5
150ms fz=0.5
151ms lift

50ms BTN_SOUTH 1
51ms BTN_SOUTH 0
150ms BTN_SOUTH 1
151ms BTN_SOUTH 0

case the time of a long press can be set
profile super-mario
set button.1.long_press_ms = 1000

0ms..999ms fz=2.5
1000ms fz=2.5

1000ms BTN_EAST 1

case steering and pressing at once
profile super-mario

0ms x=20 fz=1
100ms x=20 fz=2.5
200ms x=20 fz=1
201ms x=20 fz=1
300ms lift

0ms ABS_HAT0X 1
200ms BTN_SOUTH 1
201ms BTN_SOUTH 0
300ms ABS_HAT0X 0

case within a step releases come first, then horizontal, vertical, buttons
profile contra

0ms x=-20 fz=1
1ms x=14 y=14 fz=2.5 fy=1.5
2ms lift

0ms ABS_HAT0X -1
1ms ABS_HAT0X 1
1ms ABS_HAT0Y -1
1ms BTN_SOUTH 1
1ms BTN_EAST 1
2ms ABS_HAT0X 0
2ms ABS_HAT0Y 0
2ms BTN_SOUTH 0
2ms BTN_EAST 0

case a lift exactly at 400 ms is long
profile super-mario

0ms fz=3
399ms fz=3
400ms lift
401ms lift

400ms BTN_EAST 1
401ms BTN_EAST 0
