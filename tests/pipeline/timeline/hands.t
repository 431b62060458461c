# [gain] and left_handed: the layout for a hand.

case a gain stretches its own side: 8 mm up are as 12 mm
profile super-mario
add [gain]
add up = 1.5

0ms y=5.3 fz=1
1ms y=5.4 fz=1
2ms lift
3ms y=-7.9 fz=1
4ms y=-8 fz=1

1ms ABS_HAT0Y -1
2ms ABS_HAT0Y 0
4ms ABS_HAT0Y 1

case a gain turns the diagonals: up is nearer then
profile super-mario
add [gain]
add up = 2

0ms x=14 y=8 fz=1
1ms lift
2ms x=14 y=6.9 fz=1

0ms ABS_HAT0Y -1
1ms ABS_HAT0Y 0
2ms ABS_HAT0X 1

case for the other hand sideways forces change sides, and directions stay
profile super-mario
set left_handed = true
add [[button]]
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_NORTH", keyboard = "KEY_S" }

0ms x=20 fx=1.2 fz=1
1ms x=20 fx=-1.2 fz=1

0ms ABS_HAT0X 1
1ms BTN_NORTH 1

case for the other hand the directions are turned the other way
profile super-mario
set left_handed = true
set dpad.rotation_deg = 20

0ms angle=26 r=20 fz=1
1ms lift
2ms angle=24 r=20 fz=1

0ms ABS_HAT0Y -1
1ms ABS_HAT0Y 0
2ms ABS_HAT0X 1

case for the other hand a zone is on the other side
profile pointer
set left_handed = true
set pointer.centre_radius_mm = 28
set pointer.full_radius_mm = 30
add [[zone]]
add name = "thumb"
add from_deg = -40
add to_deg = 20
add [[button]]
add zone = "thumb"
add force = "fz"
add press_n = 1
add out = { pointer = "BTN_MIDDLE" }

0ms angle=-30 r=20 fz=1.2
1ms angle=159 r=20 fz=1.2
2ms lift
3ms angle=161 r=20 fz=1.2
4ms lift
5ms angle=-141 r=20 fz=1.2

3ms BTN_MIDDLE 1
4ms BTN_MIDDLE 0
5ms BTN_MIDDLE 1

case a hand off the middle has its directions around its own centre
profile super-mario
set centre_x_mm = 5
set centre_y_mm = -3

0ms x=12.9 y=-3 fz=1
1ms x=13 y=-3 fz=1
2ms lift
3ms x=-2.9 y=-3 fz=1
4ms x=-3 y=-3 fz=1
5ms lift
6ms x=5 y=5 fz=1

1ms ABS_HAT0X 1
2ms ABS_HAT0X 0
4ms ABS_HAT0X -1
5ms ABS_HAT0X 0
6ms ABS_HAT0Y -1

case for the other hand its centre changes sides
profile super-mario
set centre_x_mm = 5
set left_handed = true

0ms x=2.9 fz=1
1ms x=3 fz=1

1ms ABS_HAT0X 1
