#ifndef API_REPORT_TABLE_H
#define API_REPORT_TABLE_H

#include <stddef.h>

/*
 * The report for people: takes the JSON text of api_report_json() and returns a plain-text table
 * (heap string), NULL when memory is out or the text is no report.  `masspropd calc` prints it.
 */
char *api_report_table(const char *json, size_t len);

#endif
