# With turbo_ms the keys go down and up again and again while the press lasts, half of the time each.

case down in the first half of each period
profile contra
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", turbo_ms = 100 }

7ms..230ms fz=2
231ms fz=1.39

7ms BTN_SOUTH 1
57ms BTN_SOUTH 0
107ms BTN_SOUTH 1
157ms BTN_SOUTH 0
207ms BTN_SOUTH 1
231ms BTN_SOUTH 0

case each press begins with a key that is down
profile contra
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", turbo_ms = 100 }

0ms fz=2
60ms fz=2
70ms fz=1
71ms fz=2
120ms fz=2
121ms fz=2
130ms lift

0ms BTN_SOUTH 1
60ms BTN_SOUTH 0
71ms BTN_SOUTH 1
121ms BTN_SOUTH 0

case samples that come seldom lose nothing but the times between them
profile contra
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", turbo_ms = 100 }

0ms fz=2
1000ms fz=2
1050ms fz=2
1100ms fz=1

0ms BTN_SOUTH 1
1050ms BTN_SOUTH 0

case a long press in turbo begins when it becomes long
profile super-mario
set button.1.hold = { gamepad = "BTN_EAST", keyboard = "KEY_X", turbo_ms = 80 }

0ms fz=2
399ms fz=2
400ms fz=2
440ms fz=2
480ms fz=2
490ms lift

400ms BTN_EAST 1
440ms BTN_EAST 0
480ms BTN_EAST 1
490ms BTN_EAST 0

case the wheel of the pointer turns by a notch where a level begins, in each period
profile contra
set button.1.out = { pointer = "REL_WHEEL-", turbo_ms = 100 }

0ms..250ms fz=2.5
251ms lift

0ms REL_WHEEL -1
50ms REL_WHEEL 0
100ms REL_WHEEL -1
150ms REL_WHEEL 0
200ms REL_WHEEL -1
250ms REL_WHEEL 0
