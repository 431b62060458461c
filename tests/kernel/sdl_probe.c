// What a game that uses SDL sees: its joysticks, whether they count as game controllers, and their events.
// sdl_probe COUNT LIMIT_MS: lists the joysticks, says "ready", then prints COUNT presses and releases.
// Exit code 1 if they do not come in time.
#include <SDL.h>

static void list(int index)
{
	char guid[33];
	SDL_GameController *controller;
	char *mapping;

	SDL_JoystickGetGUIDString(SDL_JoystickGetDeviceGUID(index), guid, sizeof(guid));
	printf("joystick %s name '%s' controller %d\n", guid, SDL_JoystickNameForIndex(index), SDL_IsGameController(index));
	controller = SDL_GameControllerOpen(index);
	mapping = controller ? SDL_GameControllerMapping(controller) : NULL;
	printf("mapping %s\n", mapping ? mapping : "none");
	SDL_free(mapping);
}

static int print(const SDL_Event *event)
{
	const SDL_ControllerButtonEvent *button = &event->cbutton;

	if (event->type != SDL_CONTROLLERBUTTONDOWN && event->type != SDL_CONTROLLERBUTTONUP)
		return 0;
	printf("button %s %d\n", SDL_GameControllerGetStringForButton(button->button), button->state == SDL_PRESSED);
	fflush(stdout);
	return 1;
}

int main(int count, char **arguments)
{
	int wanted = count == 3 ? SDL_atoi(arguments[1]) : 0;
	Uint64 end = SDL_GetTicks64() + (count == 3 ? SDL_atoi(arguments[2]) : 0);
	SDL_Event event;

	// There is no window, so there is no focus to wait for.
	SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
	if (SDL_Init(SDL_INIT_GAMECONTROLLER) != 0) {
		fprintf(stderr, "SDL_Init: %s\n", SDL_GetError());
		return 2;
	}
	for (int index = 0; index < SDL_NumJoysticks(); index++)
		list(index);
	printf("ready\n");
	fflush(stdout);
	while (wanted > 0 && SDL_GetTicks64() < end)
		if (SDL_WaitEventTimeout(&event, 100))
			wanted -= print(&event);
	SDL_Quit();
	return wanted > 0;
}
