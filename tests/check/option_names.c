/*
 * Prints the name of every option of a request, one a line, for tests/check/docs; one that is part
 * of the contract but not served yet with " later" behind it.
 */
#include <stdio.h>

#include "api/option_table.h"

int main(void)
{
	for (size_t i = 0; i < api_option_count; i++)
		printf("%s%s\n", api_option_rows[i].name, api_option_rows[i].later ? " later" : "");
	return 0;
}
