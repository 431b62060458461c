/* The pad's end of the tactpad wire, version 1: messages out, commands in.
 *
 * Freestanding C99: no allocation, no library, no floating point, no state but the receiver. The layout of
 * every byte is in ../README.md; tests hold this code to the Rust crate beside it, byte for byte.
 */
#ifndef TACTPAD_PROTO_H
#define TACTPAD_PROTO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    TACTPAD_PROTOCOL_VERSION = 1,
    TACTPAD_CHANNELS = 9,
    /* The most channels of a pad that has fewer than nine. */
    TACTPAD_FEW_CHANNELS_MAX = 8,
    TACTPAD_SERIAL_NUMBER_LEN = 16,
    /* The longest frame that a pad sends: a sample, stuffed, with its closing zero. */
    TACTPAD_ENCODED_MAX = 60,
    /* A HID report with its report id. */
    TACTPAD_REPORT_LEN = 64,
    TACTPAD_REPORT_DESCRIPTOR_LEN = 29,
    /* Samples per second that a host may ask for. */
    TACTPAD_RATE_MIN_HZ = 100,
    TACTPAD_RATE_MAX_HZ = 8000
};

/* Bits of a sample's status. Bit 0 to 8 says that channel 0 to 8 is out of range or its bridge is open. */
enum {
    TACTPAD_STATUS_TEMPERATURE_INVALID = 1 << 9,
    TACTPAD_STATUS_RESTARTED = 1 << 10,
    TACTPAD_STATUS_SUPPLY_FAULT = 1 << 11
};

/* One conversion of all nine channels. */
struct tactpad_sample {
    uint32_t sequence;
    /* Microseconds since the pad started, at the end of the conversion. */
    uint64_t time_us;
    /* m0x m0y m0z m1x m1y m1z m2x m2y m2z, as the converter read them. */
    int32_t counts[TACTPAD_CHANNELS];
    int16_t temperature_centi_c;
    /* Bits that mean nothing yet are sent as zero, whatever they are here. */
    uint16_t status;
};

/* One conversion of a pad that has one to eight channels. More than eight are sent as eight. */
struct tactpad_channels {
    uint32_t sequence;
    /* Microseconds since the pad started, at the end of the conversion. */
    uint64_t time_us;
    uint8_t channels;
    int32_t counts[TACTPAD_FEW_CHANNELS_MAX];
    int16_t temperature_centi_c;
    /* Bits that mean nothing yet, and those of channels that are not there, are sent as zero. */
    uint16_t status;
};

/* A deviation that the pad cannot tell. */
#define TACTPAD_DEVIATION_UNKNOWN 65535u

/* What touches the plate now, of a pad that decodes on its own. */
struct tactpad_contact {
    uint32_t sequence;
    /* Microseconds since the pad started, when the contact was measured. */
    uint64_t time_us;
    /* x, y in micrometres from the centre of the plate. */
    int32_t place_um[2];
    /* Forces on the plate along x, along y, and into it, in millinewtons. */
    int32_t force_mn[3];
    /* Standard deviations: of x and y in micrometres; of forces along x and y, and of that into the plate, in millinewtons. */
    uint16_t place_deviation_um;
    uint16_t shear_deviation_mn;
    uint16_t normal_deviation_mn;
    bool is_touched;
    bool has_shear;
    /* Of a restart and of a supply fault; other bits are sent as zero. */
    uint16_t status;
};

/* Who the pad is and what its counts are worth. */
struct tactpad_identity {
    /* Visible ASCII, ended by a zero unless all sixteen are used. What follows a zero is not sent. */
    char serial_number[TACTPAD_SERIAL_NUMBER_LEN];
    /* 9; 1 to 8 of a pad that has fewer; 0 of one that decodes on its own. */
    uint8_t channels;
    uint8_t count_bits;
    uint16_t rate_hz;
    uint32_t picovolts_per_count;
};

/* What became of a command. */
enum tactpad_result { TACTPAD_DONE = 0, TACTPAD_REFUSED = 1, TACTPAD_UNKNOWN = 2 };

/* Write one frame to out, with its closing zero; return its length. */
size_t tactpad_encode_sample(const struct tactpad_sample *sample, uint8_t out[TACTPAD_ENCODED_MAX]);
size_t tactpad_encode_channels(const struct tactpad_channels *sample, uint8_t out[TACTPAD_ENCODED_MAX]);
size_t tactpad_encode_contact(const struct tactpad_contact *sample, uint8_t out[TACTPAD_ENCODED_MAX]);
size_t tactpad_encode_identity(const struct tactpad_identity *identity, uint8_t out[TACTPAD_ENCODED_MAX]);
size_t tactpad_encode_acknowledgement(uint8_t command_kind, enum tactpad_result result,
                                      uint8_t out[TACTPAD_ENCODED_MAX]);

/* Write one input report, with its report id and padding. */
void tactpad_report_sample(const struct tactpad_sample *sample, uint8_t out[TACTPAD_REPORT_LEN]);
void tactpad_report_channels(const struct tactpad_channels *sample, uint8_t out[TACTPAD_REPORT_LEN]);
void tactpad_report_contact(const struct tactpad_contact *sample, uint8_t out[TACTPAD_REPORT_LEN]);
void tactpad_report_identity(const struct tactpad_identity *identity, uint8_t out[TACTPAD_REPORT_LEN]);
void tactpad_report_acknowledgement(uint8_t command_kind, enum tactpad_result result,
                                    uint8_t out[TACTPAD_REPORT_LEN]);

/* The report descriptor that a HID pad hands to its host. */
extern const uint8_t tactpad_report_descriptor[TACTPAD_REPORT_DESCRIPTOR_LEN];

/* Kinds of commands. */
enum { TACTPAD_IDENTIFY = 0x81, TACTPAD_SET_RATE = 0x82, TACTPAD_BLINK = 0x83, TACTPAD_SET_OUTPUT = 0x84 };

/* What set output asks for. */
enum { TACTPAD_OUTPUT_CHANNELS = 0, TACTPAD_OUTPUT_CONTACTS = 1 };

/* What came from the host. */
enum tactpad_event {
    /* No frame ends here. */
    TACTPAD_NOTHING,
    /* A command that this version knows. */
    TACTPAD_COMMAND,
    /* Bytes were lost, added or changed. A pad does not answer. */
    TACTPAD_DAMAGED,
    /* More bytes without a zero than any frame has. A pad does not answer. */
    TACTPAD_TOO_LONG,
    /* A good frame of a kind that this version does not know. A pad answers that. */
    TACTPAD_UNKNOWN_KIND,
    /* A good frame of a version that this is not. A pad does not answer. */
    TACTPAD_NEWER_VERSION
};

/* A command, or the kind of an unknown one. */
struct tactpad_command {
    uint8_t kind;
    /* Set rate: hertz. Blink: milliseconds. Set output: what is asked for. Else 0. */
    uint16_t value;
};

/* What is known of the frame that is coming in. Its fields are the receiver's own. */
struct tactpad_receiver {
    uint32_t crc;
    uint8_t head[4];
    /* Bytes without stuffing. */
    uint8_t len;
    /* Bytes of the present run that are still to come. */
    uint8_t left;
    bool started;
    bool overlong;
};

/* The next byte is a frame's first. */
void tactpad_receiver_reset(struct tactpad_receiver *receiver);

/* Takes the next byte from the host. *command is set when a command or an unknown kind came. */
enum tactpad_event tactpad_receive(struct tactpad_receiver *receiver, uint8_t byte,
                                   struct tactpad_command *command);

/* Reads an output report of len bytes that begins with its report id. */
enum tactpad_event tactpad_decode_report(const uint8_t *report, size_t len, struct tactpad_command *command);

#ifdef __cplusplus
}
#endif

#endif
