# A fault releases everything and forgets presses; nothing is tapped for them.

case a fault in a short press taps nothing
profile super-mario

0ms fz=2.5
100ms fault
101ms lift
102ms lift

nothing

case a fault in a long press releases it for good
profile super-mario

0ms..450ms fz=2.5
451ms fault
452ms..999ms fz=2.5
1000ms lift
1001ms lift

400ms BTN_EAST 1
451ms BTN_EAST 0

case after a fault a press counts again once the force was released
profile super-mario

0ms fz=2.5
100ms fault
101ms fz=2.5
150ms fz=1.4
151ms fz=1.39
200ms fz=2.5
300ms fz=1
301ms fz=1

300ms BTN_SOUTH 1
301ms BTN_SOUTH 0

case after a fault without a press the next press counts
profile super-mario

0ms fz=1
100ms fault
101ms fz=2.5
200ms fz=1
201ms fz=1

200ms BTN_SOUTH 1
201ms BTN_SOUTH 0

case after a fault a direction starts anew, with the thresholds of a start
profile super-mario

0ms x=20 fz=1
1ms x=7 fz=1
2ms fault
3ms x=7 fz=1
4ms x=8 fz=1

0ms ABS_HAT0X 1
2ms ABS_HAT0X 0
4ms ABS_HAT0X 1

case numbers that are none release everything and tap nothing
profile contra

0ms x=20 fz=2.5
1ms x=nan fz=2.5
2ms x=20 fz=2.5
3ms x=20 fz=1
4ms x=20 fz=2.5
5ms x=20 y=inf fz=2.5

0ms ABS_HAT0X 1
0ms BTN_SOUTH 1
1ms ABS_HAT0X 0
1ms BTN_SOUTH 0
2ms ABS_HAT0X 1
4ms BTN_SOUTH 1
5ms ABS_HAT0X 0
5ms BTN_SOUTH 0

case a force that is no number never taps
profile super-mario

0ms fz=2.5
100ms fz=nan
101ms lift
102ms fz=inf
103ms lift
104ms fx=-inf fz=2.5
105ms lift

nothing
