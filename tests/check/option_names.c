/*
 * Prints, for tests/check/docs, the name of every option of a request, one a line; one that is part
 * of the contract but not served yet with " later" behind it.  With an argument instead every
 * warning's code, a tab, and its sentence.
 */
#include <stdio.h>

#include "api/option_table.h"
#include "api/warnings.h"

int main(int argc, char **argv)
{
	const struct api_warning *w;

	(void)argv;
	for (size_t i = 0; argc > 1 && (w = api_warning_row(i)) != NULL; i++)
		printf("%s\t%s\n", w->code, w->message);
	for (size_t i = 0; argc == 1 && i < api_option_count; i++)
		printf("%s%s\n", api_option_rows[i].name, api_option_rows[i].later ? " later" : "");
	return 0;
}
