# [[zone]]: buttons that count in a part of the plate only.

case a button counts in its zone, edges included
profile super-mario
add [[zone]]
add name = "top"
add from_deg = 30
add to_deg = 150
add inner_radius_mm = 10
add [[button]]
add zone = "top"
add force = "fz"
add press_n = 1
add out = { gamepad = "BTN_NORTH", keyboard = "KEY_S" }

0ms angle=29 r=9 fz=1.2
1ms angle=29 r=12 fz=0.1
2ms angle=31 r=12 fz=1.2
3ms lift
4ms angle=149 r=10 fz=1
5ms lift

0ms ABS_HAT0X 1
1ms ABS_HAT0X 0
2ms ABS_HAT0X 1
2ms BTN_NORTH 1
3ms ABS_HAT0X 0
3ms BTN_NORTH 0
4ms ABS_HAT0X -1
4ms BTN_NORTH 1
5ms ABS_HAT0X 0
5ms BTN_NORTH 0

case a force that is on presses where it comes into the zone, and ends 8 degrees beyond it
profile pointer
set pointer.centre_radius_mm = 20
add [[zone]]
add name = "top"
add from_deg = 30
add to_deg = 150
add [[button]]
add zone = "top"
add force = "fz"
add press_n = 1
add out = { pointer = "BTN_MIDDLE" }

0ms angle=20 r=20 fz=1.2
1ms angle=30.1 r=20 fz=1.2
2ms angle=22.1 r=20 fz=1.2
3ms angle=21.9 r=20 fz=1.2
4ms angle=29.9 r=20 fz=1.2
5ms angle=30.1 r=20 fz=1.2
6ms lift

1ms BTN_MIDDLE 1
3ms BTN_MIDDLE 0
5ms BTN_MIDDLE 1
6ms BTN_MIDDLE 0

case who slides off a tap button taps nothing
profile pointer
set pointer.centre_radius_mm = 28
set pointer.full_radius_mm = 30
add [[zone]]
add name = "middle"
add outer_radius_mm = 10
add [[button]]
add zone = "middle"
add force = "fz"
add press_n = 1
add tap = { pointer = "BTN_MIDDLE" }

0ms x=5 fz=1.2
1ms x=11.4 fz=1.2
2ms x=11.6 fz=1.2
3ms lift
10ms x=5 fz=1.2
11ms x=11.4 fz=1.2
12ms lift
13ms lift

12ms BTN_MIDDLE 1
13ms BTN_MIDDLE 0

case rings: a held one reaches 1.5 mm farther in and out
profile pointer
set pointer.centre_radius_mm = 28
set pointer.full_radius_mm = 30
add [[zone]]
add name = "inner"
add outer_radius_mm = 10
add [[zone]]
add name = "outer"
add inner_radius_mm = 10
add [[button]]
add zone = "inner"
add force = "fz"
add press_n = 1
add out = { pointer = "BTN_LEFT" }
add [[button]]
add zone = "outer"
add force = "fz"
add press_n = 1
add out = { pointer = "BTN_RIGHT" }

0ms x=9 fz=1.2
1ms x=11.4 fz=1.2
2ms x=11.6 fz=1.2
3ms x=8.6 fz=1.2
4ms x=8.4 fz=1.2

0ms BTN_LEFT 1
2ms BTN_LEFT 0
2ms BTN_RIGHT 1
4ms BTN_RIGHT 0
4ms BTN_LEFT 1

case of two zones that overlap the first one counts
profile pointer
set pointer.centre_radius_mm = 28
set pointer.full_radius_mm = 30
add [[zone]]
add name = "top"
add from_deg = 45
add to_deg = 135
add [[zone]]
add name = "all"
add [[button]]
add zone = "top"
add force = "fz"
add press_n = 1
add out = { pointer = "BTN_LEFT" }
add [[button]]
add zone = "all"
add force = "fz"
add press_n = 1
add out = { pointer = "BTN_RIGHT" }

0ms y=10 fz=1.2
1ms lift
2ms y=-10 fz=1.2

0ms BTN_LEFT 1
1ms BTN_LEFT 0
2ms BTN_RIGHT 1

case a chord: a direction and a force
profile contra
add [[button]]
add zone = "down"
add force = "fz"
add press_n = 2
add out = { gamepad = "BTN_WEST", keyboard = "KEY_A" }

0ms y=20 fz=2.5
1ms y=-20 fz=2.5
2ms y=20 fz=2.5
3ms lift

0ms ABS_HAT0Y -1
0ms BTN_SOUTH 1
1ms ABS_HAT0Y 1
1ms BTN_WEST 1
2ms BTN_WEST 0
2ms ABS_HAT0Y -1
3ms ABS_HAT0Y 0
3ms BTN_SOUTH 0

case after a fault the zone does nothing until the force was released
profile pointer
set pointer.centre_radius_mm = 28
set pointer.full_radius_mm = 30
add [[zone]]
add name = "top"
add from_deg = 45
add to_deg = 135
add [[button]]
add zone = "top"
add force = "fz"
add press_n = 1
add out = { pointer = "BTN_MIDDLE" }

0ms y=-10 fz=1.2
1ms fault
2ms y=10 fz=1.2
3ms y=10 fz=0.6
4ms y=10 fz=1.0

4ms BTN_MIDDLE 1
