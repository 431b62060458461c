#include "tactpad_proto.h"

enum {
    HEADER_LEN = 2,
    CRC_LEN = 4,
    SAMPLE = 0x01,
    IDENTITY = 0x02,
    ACKNOWLEDGEMENT = 0x03,
    CHANNELS = 0x04,
    CONTACT = 0x05,
    SAMPLE_BODY_LEN = HEADER_LEN + 52,
    STATUS_DEFINED = 0x0FFF,
    STATUS_OF_CHANNELS = 0x01FF,
    CONTACT_TOUCHED = 1 << 0,
    CONTACT_SHEAR = 1 << 1,
    MESSAGE_REPORT_ID = 1,
    COMMAND_REPORT_ID = 2,
    /* The longest frame of any version before stuffing. */
    UNSTUFFED_MAX = 253
};

#define CRC_START 0xFFFFFFFFu

/* What is left, before the final inversion, of any bytes that are followed by their own checksum. */
#define CRC_RESIDUE 0xDEBB20E3u

/* CRC-32/ISO-HDLC of each four bits: 64 bytes instead of the 1024 of a table for whole bytes. */
static const uint32_t crc_table[16] = {
    0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4, 0x4DB26158, 0x5005713C,
    0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C, 0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C,
};

static uint32_t crc_add(uint32_t crc, uint8_t byte)
{
    crc ^= byte;
    crc = crc >> 4 ^ crc_table[crc & 0xF];
    return crc >> 4 ^ crc_table[crc & 0xF];
}

/* This and the writers below return the place after what they wrote. */
static uint8_t *put_u16(uint8_t *out, uint16_t value)
{
    out[0] = (uint8_t)value;
    out[1] = (uint8_t)(value >> 8);
    return out + 2;
}

static uint8_t *put_u32(uint8_t *out, uint32_t value)
{
    return put_u16(put_u16(out, (uint16_t)value), (uint16_t)(value >> 16));
}

static uint8_t *put_header(uint8_t *out, uint8_t kind)
{
    out[0] = TACTPAD_PROTOCOL_VERSION;
    out[1] = kind;
    return out + HEADER_LEN;
}

static uint8_t *put_sample(uint8_t *out, const struct tactpad_sample *sample)
{
    out = put_header(out, SAMPLE);
    out = put_u32(out, sample->sequence);
    out = put_u32(out, (uint32_t)sample->time_us);
    out = put_u32(out, (uint32_t)(sample->time_us >> 32));
    for (int channel = 0; channel < TACTPAD_CHANNELS; channel++)
        out = put_u32(out, (uint32_t)sample->counts[channel]);
    out = put_u16(out, (uint16_t)sample->temperature_centi_c);
    return put_u16(out, sample->status & STATUS_DEFINED);
}

static uint8_t *put_channels(uint8_t *out, const struct tactpad_channels *sample)
{
    int channels = sample->channels < TACTPAD_FEW_CHANNELS_MAX ? sample->channels : TACTPAD_FEW_CHANNELS_MAX;
    uint16_t there = (uint16_t)((1u << channels) - 1u);
    out = put_header(out, CHANNELS);
    out = put_u32(out, sample->sequence);
    out = put_u32(out, (uint32_t)sample->time_us);
    out = put_u32(out, (uint32_t)(sample->time_us >> 32));
    *out++ = (uint8_t)channels;
    *out++ = 0;
    out = put_u16(out, (uint16_t)sample->temperature_centi_c);
    out = put_u16(out, sample->status & ((STATUS_DEFINED & ~STATUS_OF_CHANNELS) | there));
    for (int channel = 0; channel < channels; channel++)
        out = put_u32(out, (uint32_t)sample->counts[channel]);
    return out;
}

static uint8_t *put_contact(uint8_t *out, const struct tactpad_contact *sample)
{
    uint16_t touched = sample->is_touched ? CONTACT_TOUCHED : 0;
    uint16_t shear = sample->has_shear ? CONTACT_SHEAR : 0;
    out = put_header(out, CONTACT);
    out = put_u32(out, sample->sequence);
    out = put_u32(out, (uint32_t)sample->time_us);
    out = put_u32(out, (uint32_t)(sample->time_us >> 32));
    for (int axis = 0; axis < 2; axis++)
        out = put_u32(out, (uint32_t)sample->place_um[axis]);
    for (int axis = 0; axis < 3; axis++)
        out = put_u32(out, (uint32_t)sample->force_mn[axis]);
    out = put_u16(out, sample->place_deviation_um);
    out = put_u16(out, sample->shear_deviation_mn);
    out = put_u16(out, sample->normal_deviation_mn);
    out = put_u16(out, touched | shear);
    return put_u16(out, sample->status & (TACTPAD_STATUS_RESTARTED | TACTPAD_STATUS_SUPPLY_FAULT));
}

static uint8_t *put_identity(uint8_t *out, const struct tactpad_identity *identity)
{
    bool ended = false;
    out = put_header(out, IDENTITY);
    for (int i = 0; i < TACTPAD_SERIAL_NUMBER_LEN; i++) {
        ended = ended || identity->serial_number[i] == 0;
        *out++ = ended ? 0 : (uint8_t)identity->serial_number[i];
    }
    *out++ = identity->channels;
    *out++ = identity->count_bits;
    out = put_u16(out, identity->rate_hz);
    return put_u32(out, identity->picovolts_per_count);
}

static uint8_t *put_acknowledgement(uint8_t *out, uint8_t command_kind, enum tactpad_result result)
{
    out = put_header(out, ACKNOWLEDGEMENT);
    *out++ = command_kind;
    *out++ = (uint8_t)result;
    return out;
}

/* Stuffs the body from body to end and its checksum. The place of each run's length is kept until it is known. */
static size_t put_frame(uint8_t *body, uint8_t *end, uint8_t *out)
{
    uint32_t crc = CRC_START;
    size_t run = 0;
    size_t len = 1;
    for (const uint8_t *byte = body; byte < end; byte++)
        crc = crc_add(crc, *byte);
    end = put_u32(end, ~crc);
    for (const uint8_t *byte = body; byte < end; byte++) {
        if (*byte == 0) {
            out[run] = (uint8_t)(len - run);
            run = len;
        } else {
            out[len] = *byte;
        }
        len++;
    }
    out[run] = (uint8_t)(len - run);
    out[len] = 0;
    return len + 1;
}

size_t tactpad_encode_sample(const struct tactpad_sample *sample, uint8_t out[TACTPAD_ENCODED_MAX])
{
    uint8_t body[SAMPLE_BODY_LEN + CRC_LEN];
    return put_frame(body, put_sample(body, sample), out);
}

size_t tactpad_encode_channels(const struct tactpad_channels *sample, uint8_t out[TACTPAD_ENCODED_MAX])
{
    uint8_t body[SAMPLE_BODY_LEN + CRC_LEN];
    return put_frame(body, put_channels(body, sample), out);
}

size_t tactpad_encode_contact(const struct tactpad_contact *sample, uint8_t out[TACTPAD_ENCODED_MAX])
{
    uint8_t body[SAMPLE_BODY_LEN + CRC_LEN];
    return put_frame(body, put_contact(body, sample), out);
}

size_t tactpad_encode_identity(const struct tactpad_identity *identity, uint8_t out[TACTPAD_ENCODED_MAX])
{
    uint8_t body[SAMPLE_BODY_LEN + CRC_LEN];
    return put_frame(body, put_identity(body, identity), out);
}

size_t tactpad_encode_acknowledgement(uint8_t command_kind, enum tactpad_result result,
                                      uint8_t out[TACTPAD_ENCODED_MAX])
{
    uint8_t body[SAMPLE_BODY_LEN + CRC_LEN];
    return put_frame(body, put_acknowledgement(body, command_kind, result), out);
}

const uint8_t tactpad_report_descriptor[TACTPAD_REPORT_DESCRIPTOR_LEN] = {
    0x06, 0x00, 0xFF, /* usage page: vendor-defined 0xFF00 */
    0x09, 0x01,       /* usage 1: a pad */
    0xA1, 0x01,       /* collection: application */
    0x15, 0x00,       /* logical minimum 0 */
    0x26, 0xFF, 0x00, /* logical maximum 255 */
    0x75, 0x08,       /* report size: 8 bits */
    0x95, 0x3F,       /* report count: 63 */
    0x85, 0x01,       /* report id 1 */
    0x09, 0x02,       /* usage 2: a message */
    0x81, 0x02,       /* input: data, variable, absolute */
    0x85, 0x02,       /* report id 2 */
    0x09, 0x03,       /* usage 3: a command */
    0x91, 0x02,       /* output: data, variable, absolute */
    0xC0              /* end of collection */
};

static void pad_report(uint8_t *report, uint8_t *end)
{
    report[0] = MESSAGE_REPORT_ID;
    while (end < report + TACTPAD_REPORT_LEN)
        *end++ = 0;
}

void tactpad_report_sample(const struct tactpad_sample *sample, uint8_t out[TACTPAD_REPORT_LEN])
{
    pad_report(out, put_sample(out + 1, sample));
}

void tactpad_report_channels(const struct tactpad_channels *sample, uint8_t out[TACTPAD_REPORT_LEN])
{
    pad_report(out, put_channels(out + 1, sample));
}

void tactpad_report_contact(const struct tactpad_contact *sample, uint8_t out[TACTPAD_REPORT_LEN])
{
    pad_report(out, put_contact(out + 1, sample));
}

void tactpad_report_identity(const struct tactpad_identity *identity, uint8_t out[TACTPAD_REPORT_LEN])
{
    pad_report(out, put_identity(out + 1, identity));
}

void tactpad_report_acknowledgement(uint8_t command_kind, enum tactpad_result result,
                                    uint8_t out[TACTPAD_REPORT_LEN])
{
    pad_report(out, put_acknowledgement(out + 1, command_kind, result));
}

/* Reads a body of len bytes, of which head holds the first four. A frame's body ends with its payload; in a
 * report padding follows it. The version is judged first, because a stranger's payload may have any length. */
static enum tactpad_event read_command(const uint8_t head[4], size_t len, bool padded,
                                       struct tactpad_command *command)
{
    size_t wanted = HEADER_LEN;
    if (len < HEADER_LEN || head[0] == 0)
        return TACTPAD_DAMAGED;
    if (head[0] != TACTPAD_PROTOCOL_VERSION)
        return TACTPAD_NEWER_VERSION;
    command->kind = head[1];
    command->value = 0;
    if (head[1] == TACTPAD_SET_RATE || head[1] == TACTPAD_BLINK || head[1] == TACTPAD_SET_OUTPUT)
        wanted += 2;
    else if (head[1] != TACTPAD_IDENTIFY)
        return TACTPAD_UNKNOWN_KIND;
    if (len < wanted || (len > wanted && !padded))
        return TACTPAD_DAMAGED;
    if (wanted > HEADER_LEN)
        command->value = (uint16_t)(head[2] | head[3] << 8);
    return TACTPAD_COMMAND;
}

enum tactpad_event tactpad_decode_report(const uint8_t *report, size_t len, struct tactpad_command *command)
{
    if (len != TACTPAD_REPORT_LEN || report[0] != COMMAND_REPORT_ID)
        return TACTPAD_DAMAGED;
    return read_command(report + 1, len - 1, true, command);
}

void tactpad_receiver_reset(struct tactpad_receiver *receiver)
{
    receiver->crc = CRC_START;
    receiver->len = 0;
    receiver->left = 0;
    receiver->started = false;
    receiver->overlong = false;
}

/* A byte of the frame without its stuffing. No command is longer than the head, and the checksum of the
 * rest is taken on the way, so nothing else need be kept. */
static enum tactpad_event take_plain(struct tactpad_receiver *receiver, uint8_t byte)
{
    if (receiver->len == UNSTUFFED_MAX) {
        receiver->overlong = true;
        return TACTPAD_TOO_LONG;
    }
    if (receiver->len < sizeof receiver->head)
        receiver->head[receiver->len] = byte;
    receiver->len++;
    receiver->crc = crc_add(receiver->crc, byte);
    return TACTPAD_NOTHING;
}

/* A zero came: the frame ends and the next begins. */
static enum tactpad_event end_frame(struct tactpad_receiver *receiver, struct tactpad_command *command)
{
    const struct tactpad_receiver frame = *receiver;
    tactpad_receiver_reset(receiver);
    if (frame.overlong || !frame.started)
        return TACTPAD_NOTHING;
    if (frame.left > 0 || frame.len < CRC_LEN || frame.crc != CRC_RESIDUE)
        return TACTPAD_DAMAGED;
    return read_command(frame.head, frame.len - (size_t)CRC_LEN, false, command);
}

enum tactpad_event tactpad_receive(struct tactpad_receiver *receiver, uint8_t byte,
                                   struct tactpad_command *command)
{
    if (byte == 0)
        return end_frame(receiver, command);
    if (receiver->overlong)
        return TACTPAD_NOTHING;
    if (receiver->left > 0) {
        receiver->left--;
        return take_plain(receiver, byte);
    }
    /* The length of the next run. The run before it, if there was one, ended in a zero. */
    receiver->left = (uint8_t)(byte - 1);
    if (receiver->started)
        return take_plain(receiver, 0);
    receiver->started = true;
    return TACTPAD_NOTHING;
}
