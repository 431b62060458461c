# hair_n: a press goes with the turns of the force.

case it ends 0.25 N below its highest and begins 0.25 N above its lowest
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 1
add hair_n = 0.25
add out = { pointer = "BTN_LEFT" }

0ms fz=1
1ms fz=2
2ms fz=1.76
3ms fz=1.75
4ms fz=1.5
5ms fz=1.74
6ms fz=1.75
7ms lift

0ms BTN_LEFT 1
3ms BTN_LEFT 0
6ms BTN_LEFT 1
7ms BTN_LEFT 0

case below the release it takes the whole press again
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 1
add hair_n = 0.5
add out = { pointer = "BTN_LEFT" }

0ms fz=1
1ms fz=0.69
2ms fz=0.99
3ms fz=1

0ms BTN_LEFT 1
1ms BTN_LEFT 0
3ms BTN_LEFT 1

case a tap button taps at each ease
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 1
add hair_n = 0.25
add tap = { pointer = "BTN_LEFT" }

0ms fz=2
10ms fz=1.5
11ms fz=1.5
20ms fz=2
30ms fz=1.5
31ms fz=1.5

10ms BTN_LEFT 1
11ms BTN_LEFT 0
30ms BTN_LEFT 1
31ms BTN_LEFT 0
