# [[layer]]: parts of a profile that are on only at times.

case a layer is on as long as its press lasts, and a button of it counts from the next sample on
profile contra
add [[layer]]
add name = "menu"
add [[button]]
add force = "fx"
add press_n = 1
add out = { layer = "menu" }
add [[button]]
add layer = "menu"
add force = "-fy"
add press_n = 1
add out = { gamepad = "BTN_START", keyboard = "KEY_ENTER" }

0ms fy=-1.5
10ms fy=0
20ms fx=1.2
21ms fx=1.2 fy=-1.5
40ms fx=0 fy=-1.5
41ms fy=-1.5
50ms lift

21ms BTN_START 1
41ms BTN_START 0

case a force that is on when its layer begins does nothing until it was released
profile contra
add [[layer]]
add name = "menu"
add [[button]]
add force = "fx"
add press_n = 1
add out = { layer = "menu" }
add [[button]]
add layer = "menu"
add force = "-fy"
add press_n = 1
add out = { gamepad = "BTN_START", keyboard = "KEY_ENTER" }

0ms fy=-1.5
20ms fx=1.2 fy=-1.5
21ms..30ms fx=1.2 fy=-1.5
40ms fx=1.2 fy=-0.2
41ms fx=1.2 fy=-1.5
42ms lift

41ms BTN_START 1
42ms BTN_START 0

case a toggled layer stays after a lift, and its next press ends it
profile contra
add [[layer]]
add name = "menu"
add [[button]]
add force = "fx"
add press_n = 1
add out = { layer = "menu", toggle = true }
add [[button]]
add layer = "menu"
add force = "-fy"
add press_n = 1
add out = { gamepad = "BTN_START", keyboard = "KEY_ENTER" }

0ms fx=1.2
10ms lift
100ms fy=-1.5
110ms lift
200ms fx=1.2
210ms lift
300ms fy=-1.5
310ms lift

100ms BTN_START 1
110ms BTN_START 0

case a sticky layer is for one press
profile contra
add [[layer]]
add name = "menu"
add [[button]]
add force = "fx"
add press_n = 1
add out = { layer = "menu", sticky = true }
add [[button]]
add layer = "menu"
add force = "-fy"
add press_n = 1
add out = { gamepad = "BTN_START", keyboard = "KEY_ENTER" }

0ms fx=1.2
10ms lift
100ms fy=-1.5
110ms lift
120ms lift
200ms fy=-1.5
210ms lift

100ms BTN_START 1
110ms BTN_START 0

case a base button counts while no layer is on
profile super-mario
remove button.1
add [[layer]]
add name = "menu"
add [[button]]
add force = "fx"
add press_n = 1
add out = { layer = "menu" }
add [[button]]
add layer = "base"
add force = "fz"
add press_n = 2
add out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z" }
add [[button]]
add layer = "menu"
add force = "fz"
add press_n = 2
add out = { gamepad = "BTN_EAST", keyboard = "KEY_X" }

0ms fz=2.5
10ms fz=0.5
20ms fz=0.5 fx=1.2
21ms fz=0.5 fx=1.2
22ms fz=2.5 fx=1.2
30ms lift

0ms BTN_SOUTH 1
10ms BTN_SOUTH 0
22ms BTN_EAST 1
30ms BTN_EAST 0

case directions are other keys in a layer, and those that it does not name stay
profile super-mario
remove button.1
add [[layer]]
add name = "menu"
add [layer.gamepad]
add up = "BTN_TL"
add [layer.keyboard]
add up = "KEY_PAGEUP"
add [[button]]
add force = "fx"
add press_n = 1
add out = { layer = "menu" }

0ms y=20 fz=1
10ms y=20 fz=1 fx=1.2
11ms y=20 fz=1 fx=1.2
20ms x=20 fz=1 fx=1.2
30ms x=20 fz=1
31ms lift

0ms ABS_HAT0Y -1
11ms ABS_HAT0Y 0
11ms BTN_TL 1
20ms BTN_TL 0
20ms ABS_HAT0X 1
31ms ABS_HAT0X 0

case a fault ends a toggled layer
profile contra
add [[layer]]
add name = "menu"
add [[button]]
add force = "fx"
add press_n = 1
add out = { layer = "menu", toggle = true }
add [[button]]
add layer = "menu"
add force = "-fy"
add press_n = 1
add out = { gamepad = "BTN_START", keyboard = "KEY_ENTER" }

0ms fx=1.2
10ms lift
20ms fault
100ms fy=-1.5
110ms lift

nothing
