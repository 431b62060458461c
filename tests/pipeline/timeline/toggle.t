# With toggle each press lets the keys go down and stay, or up again.

case the first press holds, the second lets go
profile contra
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", toggle = true }

0ms fz=2
50ms fz=1
100ms fz=1
200ms fz=2
250ms fz=1

0ms BTN_SOUTH 1
200ms BTN_SOUTH 0

case what is toggled stays down when the finger is lifted
profile contra
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", toggle = true }

0ms fz=2
50ms lift
5000ms lift
5001ms fz=2

0ms BTN_SOUTH 1
5001ms BTN_SOUTH 0

case a fault lets it go, and the next press begins anew
profile contra
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", toggle = true }

0ms fz=2
50ms lift
100ms fault
200ms fz=2
250ms lift

0ms BTN_SOUTH 1
100ms BTN_SOUTH 0
200ms BTN_SOUTH 1

case another profile lets it go
profile contra
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", toggle = true }

0ms fz=2
50ms lift
100ms switch contra
101ms lift

0ms BTN_SOUTH 1
101ms BTN_SOUTH 0

case a long press toggles when it becomes long, a short one taps as ever
profile super-mario
set button.1.hold = { gamepad = "BTN_EAST", keyboard = "KEY_X", toggle = true }

0ms fz=2
400ms fz=2
500ms fz=1
600ms fz=2
650ms fz=1
651ms fz=1
700ms fz=2
1100ms fz=2
1200ms fz=1

400ms BTN_EAST 1
650ms BTN_SOUTH 1
651ms BTN_SOUTH 0
1100ms BTN_EAST 0

case a tap toggles when the short press ends
profile super-mario
set button.1.tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", toggle = true }

0ms fz=2
100ms fz=1
200ms fz=1
300ms fz=2
399ms fz=1

100ms BTN_SOUTH 1
399ms BTN_SOUTH 0

case chatter above the release force is one press
profile contra
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", toggle = true }

0ms fz=2
1ms fz=1.9
2ms fz=2.1
3ms fz=1.4
4ms fz=2.1

0ms BTN_SOUTH 1
