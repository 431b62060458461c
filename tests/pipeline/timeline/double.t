# A press that begins less than double_press_ms after the end of a short one is a double press.

case two short presses are one double press
profile super-mario
set button.1.double = { gamepad = "BTN_WEST", keyboard = "KEY_A" }
set button.1.double_press_ms = 300

0ms fz=2
100ms fz=1
399ms fz=2
500ms fz=1.4
501ms fz=1
900ms fz=1

399ms BTN_WEST 1
501ms BTN_WEST 0

case a second press at 300 ms is another first one, and the first taps then
profile super-mario
set button.1.double = { gamepad = "BTN_WEST", keyboard = "KEY_A" }
set button.1.double_press_ms = 300

0ms fz=2
100ms fz=1
400ms fz=2
401ms fz=2
450ms lift
749ms lift
750ms lift
751ms lift

400ms BTN_SOUTH 1
401ms BTN_SOUTH 0
750ms BTN_SOUTH 1
751ms BTN_SOUTH 0

case a single press taps when no second one can come, not before
profile super-mario
set button.1.double = { gamepad = "BTN_WEST", keyboard = "KEY_A" }

0ms fz=2
100ms fz=1
349ms fz=1
350ms fz=1
351ms fz=1

350ms BTN_SOUTH 1
351ms BTN_SOUTH 0

case without a double press a tap comes at once
profile super-mario

0ms fz=2
100ms fz=1
101ms fz=1

100ms BTN_SOUTH 1
101ms BTN_SOUTH 0

case a double press lasts as long as it is held, however long
profile super-mario
set button.1.double = { gamepad = "BTN_WEST", keyboard = "KEY_A" }

0ms fz=2
50ms fz=1
100ms fz=2
5000ms fz=1.4
5001ms lift

100ms BTN_WEST 1
5001ms BTN_WEST 0

case a long press is no first one of two
profile super-mario
set button.1.double = { gamepad = "BTN_WEST", keyboard = "KEY_A" }

0ms fz=2
400ms fz=2
450ms fz=1
460ms fz=2
500ms fz=1
750ms fz=1
751ms fz=1

400ms BTN_EAST 1
450ms BTN_EAST 0
750ms BTN_SOUTH 1
751ms BTN_SOUTH 0

case a lift ends the first press, and another touch is the second
profile super-mario
set button.1.double = { gamepad = "BTN_WEST", keyboard = "KEY_A" }

0ms fz=2
50ms lift
200ms fz=2
210ms lift

200ms BTN_WEST 1
210ms BTN_WEST 0

case a fault between the two forgets the first
profile super-mario
set button.1.double = { gamepad = "BTN_WEST", keyboard = "KEY_A" }

0ms fz=2
50ms fz=1
60ms fault
100ms fz=2
150ms fz=1
400ms fz=1
401ms fz=1

400ms BTN_SOUTH 1
401ms BTN_SOUTH 0

case a fault during the second press lets its keys go
profile super-mario
set button.1.double = { gamepad = "BTN_WEST", keyboard = "KEY_A" }

0ms fz=2
50ms fz=1
100ms fz=2
150ms fault
160ms fz=2
170ms fz=1
500ms fz=1

100ms BTN_WEST 1
150ms BTN_WEST 0
