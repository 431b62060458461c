// The least a bridge can do: one key event for every frame that arrives. The yardstick of the latency test.
// echo PORT: prints the node of its virtual device, then presses and releases one key by turns, a change per frame.
// A frame ends with a zero byte.
#include <dirent.h>
#include <err.h>
#include <fcntl.h>
#include <linux/uinput.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

static int open_port(const char *path)
{
	struct termios mode;
	int port = open(path, O_RDWR | O_NOCTTY);

	if (port < 0 || tcgetattr(port, &mode) != 0)
		err(1, "%s", path);
	cfmakeraw(&mode);
	if (tcsetattr(port, TCSANOW, &mode) != 0)
		err(1, "%s: raw mode", path);
	return port;
}

static int make_device(void)
{
	struct uinput_setup setup = { .id = { .bustype = BUS_VIRTUAL, .vendor = 0x1209, .product = 1, .version = 1 } };
	int device = open("/dev/uinput", O_RDWR);

	strcpy(setup.name, "tactpad test echo");
	if (device < 0 || ioctl(device, UI_SET_EVBIT, EV_KEY) < 0 || ioctl(device, UI_SET_KEYBIT, BTN_TRIGGER) < 0 ||
	    ioctl(device, UI_DEV_SETUP, &setup) < 0 || ioctl(device, UI_DEV_CREATE) < 0)
		err(1, "/dev/uinput");
	return device;
}

static void print_node(int device)
{
	char name[64], folder[128];
	struct dirent *entry;
	DIR *entries;

	if (ioctl(device, UI_GET_SYSNAME(sizeof(name)), name) < 0)
		err(1, "name of the device");
	snprintf(folder, sizeof(folder), "/sys/devices/virtual/input/%s", name);
	entries = opendir(folder);
	if (!entries)
		err(1, "%s", folder);
	while ((entry = readdir(entries)))
		if (strncmp(entry->d_name, "event", 5) == 0)
			printf("/dev/input/%s\n", entry->d_name);
	closedir(entries);
	fflush(stdout);
}

static void answer(int device)
{
	static int down;
	struct input_event events[2] = { { .type = EV_KEY, .code = BTN_TRIGGER }, { .type = EV_SYN } };

	down = !down;
	events[0].value = down;
	if (write(device, events, sizeof(events)) != sizeof(events))
		err(1, "write to /dev/uinput");
}

int main(int count, char **arguments)
{
	unsigned char bytes[4096];
	int port, device;
	ssize_t taken;

	if (count != 2)
		errx(2, "usage: echo PORT");
	port = open_port(arguments[1]);
	device = make_device();
	print_node(device);
	while ((taken = read(port, bytes, sizeof(bytes))) > 0)
		for (ssize_t i = 0; i < taken; i++)
			if (bytes[i] == 0)
				answer(device);
	return 0;
}
