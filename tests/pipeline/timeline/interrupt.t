# permissive_hold, hold_on_other_key_press: what another press makes of one that may become long.

case without an option only its time makes a press long
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms fx=1.5 fz=2.5
60ms lift
61ms lift

50ms KEY_1 1
60ms KEY_1 0
60ms KEY_A 1
61ms KEY_A 0

case an option that is false changes nothing
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add permissive_hold = false
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms fx=1.5 fz=2.5
60ms lift
61ms lift

50ms KEY_1 1
60ms KEY_1 0
60ms KEY_A 1
61ms KEY_A 0

case hold on other key press: the other press is in the layer at once
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add hold_on_other_key_press = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms fx=1.5 fz=2.5
60ms fz=2.5
70ms lift
71ms lift

50ms KEY_2 1
60ms KEY_2 0

case hold on other key press: a direction is another press
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add hold_on_other_key_press = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms x=20 fz=2.5
60ms x=0 fz=2.5
70ms lift
71ms lift

50ms KEY_END 1
60ms KEY_END 0

case hold on other key press: what was down before is no other press
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add hold_on_other_key_press = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fx=1.5
10ms fx=1.5 fz=2.5
50ms fx=1.5 fz=2.5
60ms fx=1.5
61ms fx=1.5
70ms lift

0ms KEY_1 1
60ms KEY_A 1
61ms KEY_A 0
70ms KEY_1 0

case hold on other key press: a tap gets the modifier
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { gamepad = "BTN_NORTH", keyboard = "KEY_LEFTSHIFT" }
add hold_on_other_key_press = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms fy=1.5 fz=2.5
60ms fz=2.5
61ms fz=2.5
70ms lift

50ms KEY_LEFTSHIFT 1
60ms KEY_9 1
61ms KEY_9 0
70ms KEY_LEFTSHIFT 0

case permissive hold: a press inside another is in its layer
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add permissive_hold = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms fx=1.5 fz=2.5
60ms fz=2.5
61ms fz=2.5
70ms lift
71ms lift

60ms KEY_2 1
61ms KEY_2 0

case permissive hold: a direction inside a press is in its layer
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add permissive_hold = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms x=20 fz=2.5
60ms x=0 fz=2.5
61ms fz=2.5
70ms lift
71ms lift

60ms KEY_END 1
61ms KEY_END 0

case permissive hold: presses that end together with the finger are one inside the other
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { gamepad = "BTN_NORTH", keyboard = "KEY_LEFTSHIFT" }
add permissive_hold = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms fx=1.5 fz=2.5
60ms lift
61ms lift

60ms KEY_LEFTSHIFT 1
60ms KEY_1 1
61ms KEY_LEFTSHIFT 0
61ms KEY_1 0

case permissive hold: who ends first taps, and the other press comes after it
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add permissive_hold = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms fx=1.5 fz=2.5
60ms fx=1.5
61ms fx=1.5
70ms lift

60ms KEY_A 1
61ms KEY_A 0
61ms KEY_1 1
70ms KEY_1 0

case permissive hold: when its time is over the other press is in the layer
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add permissive_hold = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms fx=1.5 fz=2.5
399ms fx=1.5 fz=2.5
400ms fx=1.5 fz=2.5
410ms lift

400ms KEY_2 1
410ms KEY_2 0

case permissive hold: a fault forgets what waits
profile super-mario
output keyboard
remove button.1
add [[layer]]
add name = "fn"
add gamepad = { right = "BTN_TL" }
add keyboard = { right = "KEY_END" }
add [[button]]
add force = "fz"
add press_n = 2
add tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_A" }
add hold = { layer = "fn" }
add permissive_hold = true
add [[button]]
add layer = "base"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_1" }
add [[button]]
add layer = "fn"
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_EAST", keyboard = "KEY_2" }
add [[button]]
add force = "fy"
add press_n = 1
add tap = { gamepad = "BTN_WEST", keyboard = "KEY_9" }

0ms fz=2.5
50ms fx=1.5 fz=2.5
60ms fault
61ms fx=1.5 fz=2.5
70ms lift
71ms lift

nothing
