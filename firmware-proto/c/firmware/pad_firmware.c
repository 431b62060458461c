#include "pad_firmware.h"

#include "board.h"

#define SECOND_US 1000000u

static void flush(struct pad *pad)
{
    size_t taken = board_link_write(pad->outbox, pad->outbox_len);
    pad->outbox_len -= taken;
    for (size_t i = 0; i < pad->outbox_len; i++)
        pad->outbox[i] = pad->outbox[taken + i];
}

/* A frame goes out whole or not at all, so that a slow link loses samples and damages none. */
static void post(struct pad *pad, const uint8_t *frame, size_t len)
{
    if (len > PAD_OUTBOX_LEN - pad->outbox_len)
        flush(pad);
    if (len > PAD_OUTBOX_LEN - pad->outbox_len) {
        pad->bytes_not_taken += (uint32_t)len;
        return;
    }
    for (size_t i = 0; i < len; i++)
        pad->outbox[pad->outbox_len++] = frame[i];
}

/* Every deadline follows from the one before, never from the present, and what the division leaves is
 * carried on: the mean rate is exact for every rate. */
static void set_next_deadline(struct pad *pad)
{
    uint32_t rate_hz = pad->identity.rate_hz;
    pad->due_us += SECOND_US / rate_hz;
    pad->due_rest += SECOND_US % rate_hz;
    if (pad->due_rest >= rate_hz) {
        pad->due_rest -= rate_hz;
        pad->due_us++;
    }
}

static void take_sample(struct pad *pad)
{
    struct tactpad_sample sample;
    uint8_t frame[TACTPAD_ENCODED_MAX];
    sample.status = 0;
    board_adc_read(sample.counts, &sample.temperature_centi_c, &sample.status);
    sample.time_us = board_time_us();
    sample.sequence = pad->sequence++;
    if (pad->restarted)
        sample.status |= TACTPAD_STATUS_RESTARTED;
    pad->restarted = false;
    post(pad, frame, tactpad_encode_sample(&sample, frame));
}

/* Takes a sample if one is due. A short delay is made up for; after a long one the schedule begins anew. */
static void sample_if_due(struct pad *pad)
{
    uint64_t now_us = board_time_us();
    if (now_us < pad->due_us)
        return;
    if (now_us - pad->due_us > PAD_LATE_MAX_US) {
        pad->due_us = now_us;
        pad->stalls++;
    }
    take_sample(pad);
    set_next_deadline(pad);
}

/* The next sample stays where it is; from there on the new period counts. */
static enum tactpad_result set_rate(struct pad *pad, uint16_t rate_hz)
{
    if (rate_hz < TACTPAD_RATE_MIN_HZ || rate_hz > PAD_RATE_MAX_HZ)
        return TACTPAD_REFUSED;
    pad->identity.rate_hz = rate_hz;
    pad->due_rest = 0;
    return TACTPAD_DONE;
}

static void set_light(struct pad *pad, bool on)
{
    if (pad->light != on)
        board_light(on);
    pad->light = on;
}

static enum tactpad_result blink(struct pad *pad, uint16_t duration_ms)
{
    pad->light_until_us = board_time_us() + (uint64_t)duration_ms * 1000;
    set_light(pad, duration_ms > 0);
    return TACTPAD_DONE;
}

static void acknowledge(struct pad *pad, uint8_t kind, enum tactpad_result result)
{
    uint8_t frame[TACTPAD_ENCODED_MAX];
    post(pad, frame, tactpad_encode_acknowledgement(kind, result, frame));
}

static void obey(struct pad *pad, const struct tactpad_command *command)
{
    uint8_t frame[TACTPAD_ENCODED_MAX];
    switch (command->kind) {
    case TACTPAD_IDENTIFY:
        post(pad, frame, tactpad_encode_identity(&pad->identity, frame));
        break;
    case TACTPAD_SET_RATE:
        acknowledge(pad, command->kind, set_rate(pad, command->value));
        break;
    case TACTPAD_BLINK:
        acknowledge(pad, command->kind, blink(pad, command->value));
        break;
    case TACTPAD_SET_OUTPUT:
        /* It does not decode on its own. */
        acknowledge(pad, command->kind,
                    command->value == TACTPAD_OUTPUT_CHANNELS ? TACTPAD_DONE : TACTPAD_REFUSED);
        break;
    }
}

static void take_commands(struct pad *pad)
{
    uint8_t bytes[PAD_INBOX_LEN];
    struct tactpad_command command;
    size_t len = board_link_read(bytes, sizeof bytes);
    for (size_t i = 0; i < len; i++) {
        switch (tactpad_receive(&pad->receiver, bytes[i], &command)) {
        case TACTPAD_COMMAND:
            obey(pad, &command);
            break;
        case TACTPAD_UNKNOWN_KIND:
            acknowledge(pad, command.kind, TACTPAD_UNKNOWN);
            break;
        default:
            break;
        }
    }
}

void pad_start(struct pad *pad)
{
    board_identity(&pad->identity);
    pad->identity.channels = TACTPAD_CHANNELS;
    if (set_rate(pad, pad->identity.rate_hz) != TACTPAD_DONE)
        pad->identity.rate_hz = TACTPAD_RATE_MIN_HZ;
    tactpad_receiver_reset(&pad->receiver);
    pad->due_us = board_time_us();
    pad->due_rest = 0;
    pad->sequence = 0;
    pad->restarted = true;
    pad->light = false;
    pad->outbox_len = 0;
    pad->bytes_not_taken = 0;
    pad->stalls = 0;
    board_light(false);
}

void pad_step(struct pad *pad)
{
    board_wait_until(pad->due_us);
    sample_if_due(pad);
    take_commands(pad);
    if (pad->light && board_time_us() >= pad->light_until_us)
        set_light(pad, false);
    flush(pad);
}
