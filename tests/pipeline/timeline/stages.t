# light and hard: two stages of one press.

case without a skip light comes first and hard on top
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 1
add light = { pointer = "BTN_LEFT" }
add hard = { pointer = "BTN_RIGHT" }
add hard_press_n = 3

0ms fz=0.9
1ms fz=1
2ms fz=2.9
3ms fz=3
4ms fz=2.1
5ms fz=2
6ms fz=0.7
7ms fz=0.6

1ms BTN_LEFT 1
3ms BTN_RIGHT 1
5ms BTN_RIGHT 0
7ms BTN_LEFT 0

case may skip: hard at 149 ms is hard alone
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 1
add light = { pointer = "BTN_LEFT" }
add hard = { pointer = "BTN_RIGHT" }
add hard_press_n = 3
add skip = "may"

0ms fz=1
149ms fz=3
300ms fz=2.5
301ms fz=2
302ms fz=3
400ms lift

149ms BTN_RIGHT 1
301ms BTN_RIGHT 0
302ms BTN_RIGHT 1
400ms BTN_RIGHT 0

case may skip: hard at 150 ms comes on top of light
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 1
add light = { pointer = "BTN_LEFT" }
add hard = { pointer = "BTN_RIGHT" }
add hard_press_n = 3
add skip = "may"

0ms fz=1
149ms fz=2.9
150ms fz=3
151ms fz=2
152ms lift

150ms BTN_LEFT 1
150ms BTN_RIGHT 1
151ms BTN_RIGHT 0
152ms BTN_LEFT 0

case must skip: after a slow light press hard never comes
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 1
add light = { pointer = "BTN_LEFT" }
add hard = { pointer = "BTN_RIGHT" }
add hard_press_n = 3
add skip = "must"

0ms fz=1
150ms fz=1
200ms fz=4
300ms lift
301ms fz=4
400ms lift

150ms BTN_LEFT 1
300ms BTN_LEFT 0
301ms BTN_RIGHT 1
400ms BTN_RIGHT 0

case a press that ends before it is either taps the light one
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 1
add light = { pointer = "BTN_LEFT" }
add hard = { pointer = "BTN_RIGHT" }
add hard_press_n = 3
add skip = "may"
add skip_ms = 300

0ms fz=1
299ms lift
300ms lift

299ms BTN_LEFT 1
300ms BTN_LEFT 0

case a fault forgets a press that waits
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 1
add light = { pointer = "BTN_LEFT" }
add hard = { pointer = "BTN_RIGHT" }
add hard_press_n = 3
add skip = "must"

0ms fz=1
10ms fault
200ms fz=4
201ms lift
202ms fz=4

202ms BTN_RIGHT 1
