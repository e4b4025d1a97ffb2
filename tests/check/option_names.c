/* Prints the name of every option of a request, one a line, for tests/check/docs. */
#include <stdio.h>

#include "api/options.h"

int main(void)
{
	const char *name;

	for (size_t i = 0; (name = api_option_name(i)) != NULL; i++)
		puts(name);
	return 0;
}
