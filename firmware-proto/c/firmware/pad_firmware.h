/* The reference firmware of a pad: samples at its rate, frames them, answers commands. It knows no hardware
 * but what board.h names. */
#ifndef TACTPAD_PAD_FIRMWARE_H
#define TACTPAD_PAD_FIRMWARE_H

#include "tactpad_proto.h"

/* The fastest rate that converter and line can do. A UART carries its baud rate / 660 with room for replies. */
#ifndef PAD_RATE_MAX_HZ
#define PAD_RATE_MAX_HZ TACTPAD_RATE_MAX_HZ
#endif

/* Later than this, samples that were missed are not made up for. */
#define PAD_LATE_MAX_US 100000

enum {
    /* Room for four samples that the link did not take yet. */
    PAD_OUTBOX_LEN = 4 * TACTPAD_ENCODED_MAX,
    /* No more bytes from the host are looked at between two samples, so that a flood stops nothing. */
    PAD_INBOX_LEN = 32
};

struct pad {
    struct tactpad_identity identity;
    struct tactpad_receiver receiver;
    /* When the next sample is due: whole microseconds, and the rest in parts of 1 / rate. */
    uint64_t due_us;
    uint32_t due_rest;
    uint32_t sequence;
    bool restarted;
    uint64_t light_until_us;
    bool light;
    uint8_t outbox[PAD_OUTBOX_LEN];
    size_t outbox_len;
    /* Bytes of frames that were dropped because the link took nothing for so long. */
    uint32_t bytes_not_taken;
    /* How often the board was so late that samples were left out. */
    uint32_t stalls;
};

/* Begins: the first sample is due at once. */
void pad_start(struct pad *pad);

/* Waits for the next deadline and does what is due. Call it again and again. */
void pad_step(struct pad *pad);

#endif
