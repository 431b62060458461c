# [[macro]]: keys that are pressed one after the other.

case a macro plays to its end, also when the finger is lifted
profile super-mario
remove button.1
add [[macro]]
add name = "combo"
add steps = [{ gamepad = "BTN_SOUTH", keyboard = "KEY_Z", for_ms = 50 }, { wait_ms = 30 }, { gamepad = "BTN_EAST", keyboard = "KEY_X", for_ms = 60 }]
add [[button]]
add force = "fz"
add press_n = 2
add tap = { macro = "combo" }

0ms fz=2.5
10ms lift
59ms lift
60ms lift
89ms lift
90ms lift
149ms lift
150ms lift

10ms BTN_SOUTH 1
60ms BTN_SOUTH 0
90ms BTN_EAST 1
150ms BTN_EAST 0

case a key of two steps that follow each other stays down
profile super-mario
remove button.1
add [[macro]]
add name = "combo"
add steps = [{ gamepad = "BTN_SOUTH", keyboard = "KEY_Z" }, { gamepad = "BTN_SOUTH+BTN_EAST", keyboard = "KEY_Z+KEY_X" }]
add [[button]]
add force = "fz"
add press_n = 2
add out = { macro = "combo" }

0ms fz=2.5
49ms fz=2.5
50ms fz=2.5
99ms fz=2.5
100ms fz=2.5
200ms lift

0ms BTN_SOUTH 1
50ms BTN_EAST 1
100ms BTN_SOUTH 0
100ms BTN_EAST 0

case a press while a macro plays does not begin it anew, one after its end does
profile super-mario
remove button.1
add [[macro]]
add name = "combo"
add steps = [{ gamepad = "BTN_SOUTH", keyboard = "KEY_Z", for_ms = 100 }]
add [[button]]
add force = "fz"
add press_n = 2
add out = { macro = "combo" }

0ms fz=2.5
20ms lift
40ms fz=2.5
99ms fz=2.5
100ms fz=2.5
120ms lift
130ms fz=2.5
230ms lift

0ms BTN_SOUTH 1
100ms BTN_SOUTH 0
130ms BTN_SOUTH 1
230ms BTN_SOUTH 0

case a macro has its controls for its own while it plays
profile super-mario
remove button.1
add [[macro]]
add name = "fireball"
add steps = [{ gamepad = "ABS_HAT0Y+", keyboard = "KEY_DOWN" }, { gamepad = "ABS_HAT0X-", keyboard = "KEY_LEFT" }]
add [[button]]
add force = "fz"
add press_n = 2
add out = { macro = "fireball" }

0ms x=20 fz=1
10ms x=20 fz=2.5
60ms x=20 fz=2.5
110ms x=20 fz=2.5
120ms lift

0ms ABS_HAT0X 1
10ms ABS_HAT0X 0
10ms ABS_HAT0Y 1
60ms ABS_HAT0Y 0
60ms ABS_HAT0X -1
110ms ABS_HAT0X 1
120ms ABS_HAT0X 0

case a fault ends a macro
profile super-mario
remove button.1
add [[macro]]
add name = "combo"
add steps = [{ gamepad = "BTN_SOUTH", keyboard = "KEY_Z", for_ms = 100 }]
add [[button]]
add force = "fz"
add press_n = 2
add out = { macro = "combo" }

0ms fz=2.5
20ms lift
30ms fault
40ms lift

0ms BTN_SOUTH 1
30ms BTN_SOUTH 0

case macros play one after the other
profile super-mario
output keyboard
remove button.1
add [[macro]]
add name = "paren"
add steps = [{ gamepad = "BTN_TL", keyboard = "KEY_LEFTSHIFT+KEY_9", for_ms = 200 }]
add [[macro]]
add name = "brace"
add steps = [{ gamepad = "BTN_TR", keyboard = "KEY_LEFTBRACE" }]
add [[button]]
add force = "fx"
add press_n = 1
add out = { macro = "paren" }
add [[button]]
add force = "fz"
add press_n = 2
add out = { macro = "brace" }

0ms fx=1.5 fz=0.5
50ms fx=1.5 fz=2.5
199ms fx=1.5 fz=2.5
200ms lift
250ms lift

0ms KEY_LEFTSHIFT 1
0ms KEY_9 1
200ms KEY_LEFTSHIFT 0
200ms KEY_9 0
200ms KEY_LEFTBRACE 1
250ms KEY_LEFTBRACE 0

case modifiers of the finger are lifted while a macro plays
profile super-mario
output keyboard
remove button.1
add [[macro]]
add name = "letter"
add steps = [{ gamepad = "BTN_TL", keyboard = "KEY_A" }]
add [[button]]
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_TR", keyboard = "KEY_LEFTCTRL" }
add [[button]]
add force = "fz"
add press_n = 2
add out = { macro = "letter" }

0ms fx=1.5
10ms fx=1.5 fz=2.5
59ms fx=1.5 fz=2.5
60ms fx=1.5 fz=2.5
70ms lift

0ms KEY_LEFTCTRL 1
10ms KEY_LEFTCTRL 0
10ms KEY_A 1
60ms KEY_A 0
60ms KEY_LEFTCTRL 1
70ms KEY_LEFTCTRL 0

case no other key goes down while a macro holds a modifier
profile super-mario
output keyboard
remove button.1
add [[macro]]
add name = "paren"
add steps = [{ gamepad = "BTN_TL", keyboard = "KEY_LEFTSHIFT+KEY_9", for_ms = 100 }, { wait_ms = 100 }]
add [[button]]
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_TR", keyboard = "KEY_Q" }
add [[button]]
add force = "fz"
add press_n = 2
add out = { macro = "paren" }

0ms fz=2.5
20ms fx=1.5 fz=2.5
100ms fx=1.5 fz=2.5
110ms lift
300ms lift

0ms KEY_LEFTSHIFT 1
0ms KEY_9 1
100ms KEY_LEFTSHIFT 0
100ms KEY_9 0
100ms KEY_Q 1
110ms KEY_Q 0

case a key that the finger holds goes up before a macro presses it
profile super-mario
output keyboard
remove button.1
add [[macro]]
add name = "paren"
add steps = [{ gamepad = "BTN_TL", keyboard = "KEY_LEFTSHIFT+KEY_9" }]
add [[button]]
add force = "fx"
add press_n = 1
add out = { gamepad = "BTN_TR", keyboard = "KEY_9" }
add [[button]]
add force = "fz"
add press_n = 2
add out = { macro = "paren" }

0ms fx=1.5
10ms fx=1.5 fz=2.5
49ms fx=1.5 fz=2.5
50ms fx=1.5 fz=2.5
100ms lift

0ms KEY_9 1
10ms KEY_9 0
50ms KEY_LEFTSHIFT 1
50ms KEY_9 1
100ms KEY_LEFTSHIFT 0
100ms KEY_9 0
