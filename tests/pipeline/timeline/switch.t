# Another profile in the middle of a contact.

case a direction that both profiles hold goes on without an edge
profile super-mario

0ms x=20 fz=1
10ms switch tetris
11ms x=20 fz=1
12ms lift

0ms ABS_HAT0X 1
12ms ABS_HAT0X 0

case it continues with the thresholds that end it
profile super-mario

0ms x=20 fz=1
1ms x=7 fz=0.25
10ms switch tetris
11ms x=7 fz=0.25
12ms x=6 fz=0.25

0ms ABS_HAT0X 1
12ms ABS_HAT0X 0

case a diagonal settles where there are none
profile contra

0ms angle=50 r=20 fz=1
10ms switch super-mario
11ms angle=50 r=20 fz=1

0ms ABS_HAT0X 1
0ms ABS_HAT0Y -1
11ms ABS_HAT0X 0

case a press under way neither taps nor holds in the new profile
profile super-mario

0ms fz=2.5
100ms switch tetris
101ms..600ms fz=2.5
601ms lift
602ms lift

nothing

case a hold of the old profile ends with the step after the switch
profile contra

0ms fz=2.5
100ms switch super-mario
101ms fz=2.5
700ms fz=1.39
701ms fz=1.39

0ms BTN_SOUTH 1
101ms BTN_SOUTH 0

case once released, the force presses in the new profile
profile super-mario

0ms fz=2.5
100ms switch contra
101ms fz=2.5
102ms fz=1.4
103ms fz=1.39
104ms fz=2.0

104ms BTN_SOUTH 1

case a force that pressed nothing before does not press by the switch alone
profile super-mario

0ms fz=1 fy=3
100ms switch contra
101ms fz=1 fy=3
102ms fz=1 fy=0.5
103ms fz=1 fy=1.2

103ms BTN_EAST 1

case a switch between contacts changes nothing else
profile super-mario

0ms fz=2.5
100ms lift
101ms lift
102ms switch contra
103ms fz=2.0

100ms BTN_SOUTH 1
101ms BTN_SOUTH 0
103ms BTN_SOUTH 1

case a switch without a step between keeps an old press forgotten
profile super-mario

0ms fz=2.5
100ms switch tetris
100ms switch contra
101ms fz=2.5

nothing

case a press of a more sensitive profile does not become one of a stiffer profile
profile super-mario
set button.1.press_n = 1.6

0ms fz=1.7
100ms switch contra
101ms fz=1.7
102ms fz=2.2
103ms fz=1.39
104ms fz=2.2

104ms BTN_SOUTH 1

case the same profile read again: a button that stands unchanged goes on
profile contra

0ms x=20 fz=2.5
100ms switch contra
101ms x=20 fz=2.5
200ms x=20 fz=1.39

0ms ABS_HAT0X 1
0ms BTN_SOUTH 1
200ms BTN_SOUTH 0

case the same profile read again: a long press is counted from its beginning
profile super-mario

0ms fz=2.5
399ms switch super-mario
399ms fz=2.5
400ms fz=2.5

400ms BTN_EAST 1

case a direction does not outlive a profile without directions
profile super-mario

0ms x=20 fz=1
5ms switch one-button
10ms x=20 fz=1
20ms lift
25ms switch super-mario
30ms x=7 fz=1
40ms lift

0ms ABS_HAT0X 1
10ms ABS_HAT0X 0
