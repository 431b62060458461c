// The least that can be done: one key event for whatever arrives. The yardstick of the latency test.
// echo PORT: presses and releases one key of a virtual device by turns, a change per frame. A frame ends with a zero byte.
// echo NODE: the same of an input device, which it takes for itself, a change per report.
#include <err.h>
#include <fcntl.h>
#include <linux/uinput.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

static void make_raw(int port, const char *path)
{
	struct termios mode;

	if (tcgetattr(port, &mode) != 0)
		err(1, "%s", path);
	cfmakeraw(&mode);
	if (tcsetattr(port, TCSANOW, &mode) != 0)
		err(1, "%s: raw mode", path);
}

static int make_device(void)
{
	struct uinput_setup setup = { .id = { .bustype = BUS_VIRTUAL, .vendor = 0x1209, .product = 1, .version = 1 } };
	int device = open("/dev/uinput", O_RDWR);

	strcpy(setup.name, "tactpad test echo");
	if (device < 0 || ioctl(device, UI_SET_EVBIT, EV_KEY) < 0 || ioctl(device, UI_SET_KEYBIT, KEY_CAPSLOCK) < 0 ||
	    ioctl(device, UI_DEV_SETUP, &setup) < 0 || ioctl(device, UI_DEV_CREATE) < 0)
		err(1, "/dev/uinput");
	return device;
}

static void answer(int device)
{
	static int down;
	struct input_event events[2] = { { .type = EV_KEY, .code = KEY_CAPSLOCK }, { .type = EV_SYN } };

	down = !down;
	events[0].value = down;
	if (write(device, events, sizeof(events)) != sizeof(events))
		err(1, "write to /dev/uinput");
}

static int frames(const unsigned char *bytes, ssize_t taken)
{
	int count = 0;

	for (ssize_t i = 0; i < taken; i++)
		count += bytes[i] == 0;
	return count;
}

static int reports(const struct input_event *events, ssize_t taken)
{
	int count = 0;

	for (ssize_t i = 0; i < taken / (ssize_t)sizeof(*events); i++)
		count += events[i].type == EV_SYN && events[i].code == SYN_REPORT;
	return count;
}

int main(int count, char **arguments)
{
	union {
		unsigned char bytes[4096];
		struct input_event events[64];
	} in;
	int source, is_device, device;
	ssize_t taken;

	if (count != 2)
		errx(2, "usage: echo PORT|NODE");
	source = open(arguments[1], O_RDWR | O_NOCTTY);
	if (source < 0)
		err(1, "%s", arguments[1]);
	is_device = ioctl(source, EVIOCGRAB, 1) == 0;
	if (!is_device)
		make_raw(source, arguments[1]);
	device = make_device();
	while ((taken = read(source, &in, sizeof(in))) > 0)
		for (int left = is_device ? reports(in.events, taken) : frames(in.bytes, taken); left > 0; left--)
			answer(device);
	return 0;
}
