#include "server/calc.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "api/job.h"
#include "api/options.h"
#include "api/report_table.h"
#include "server/clock.h"
#include "server/second.h"

enum { GOOD = 0, NOT_SOLID = 1, UNREADABLE = 2 };

struct calc {
	bool json;
	bool together; /* the files are one solid */
	char *query;   /* the options as a URL's query: one parser serves both */
	size_t query_len;
	int files;
	const struct mp_second *second; /* NULL: none */
};

static int append(struct calc *c, const char *text, size_t len, bool escape)
{
	static const char hex[] = "0123456789ABCDEF";
	char *grown = realloc(c->query, c->query_len + 3 * len + 2);

	if (grown == NULL)
		return -1;
	c->query = grown;
	for (size_t i = 0; i < len; i++) {
		unsigned char ch = (unsigned char)text[i];

		if (escape) {
			c->query[c->query_len++] = '%';
			c->query[c->query_len++] = hex[ch >> 4];
			c->query[c->query_len++] = hex[ch & 15];
		} else {
			c->query[c->query_len++] = text[i];
		}
	}
	c->query[c->query_len] = '\0';
	return 0;
}

static int add_option(struct calc *c, const char *name, size_t len, const char *value)
{
	return append(c, "&", c->query_len > 0, false) != 0 || append(c, name, len, true) != 0 ||
		       append(c, "=", 1, false) != 0 || append(c, value, strlen(value), true) != 0
		   ? -1
		   : 0;
}

static void help(void)
{
	(void)puts("usage: masspropd calc [OPTIONS] FILE...   (- is standard input)\n\n"
		   "  --json      one report a line as JSON, the same as the service answers\n"
		   "  --together  the files are parts of one solid: one report\n"
		   "  --help      this text\n\n"
		   "and the service's options, as --NAME VALUE or --NAME=VALUE (see README.md):");
	for (size_t i = 0; api_option_name(i) != NULL; i++)
		(void)printf("  --%s\n", api_option_name(i));
	(void)puts("\nexit status: 0 good, 1 some mesh is no solid (with --strict), "
		   "2 some file could not be read");
}

static bool is_boolean(const char *name, size_t len)
{
	return (len == 6 && memcmp(name, "strict", 6) == 0) ||
	       (len == 4 && memcmp(name, "flip", 4) == 0);
}

/* One flag at argv[*at]; -1: print help (0 arguments wrong) or misuse. */
static int flag(struct calc *c, int argc, char **argv, int *at)
{
	const char *name = argv[*at] + 2, *equals = strchr(name, '=');
	size_t len = equals != NULL ? (size_t)(equals - name) : strlen(name);

	if (strcmp(name, "json") == 0) {
		c->json = true;
		return 0;
	}
	if (strcmp(name, "together") == 0) {
		c->together = true;
		return 0;
	}
	if (equals != NULL)
		return add_option(c, name, len, equals + 1);
	if (is_boolean(name, len) && (*at + 1 >= argc || (strcmp(argv[*at + 1], "true") != 0 &&
							  strcmp(argv[*at + 1], "false") != 0)))
		return add_option(c, name, len, "true");
	if (*at + 1 >= argc) {
		(void)fprintf(stderr, "masspropd calc: --%s needs a value\n", name);
		return -1;
	}
	return add_option(c, name, len, argv[++*at]);
}

/* All bytes of a file, or as many as the verdict takes; -1: it cannot be read. */
static int feed(struct api_job *job, const char *file)
{
	static uint8_t chunk[256 << 10];
	bool standard = strcmp(file, "-") == 0;
	int fd = standard ? STDIN_FILENO : open(file, O_RDONLY | O_CLOEXEC);
	ssize_t n = -1;

	while (fd >= 0 && (n = read(fd, chunk, sizeof chunk)) > 0)
		if (api_job_push(job, chunk, (size_t)n) != 0)
			break;
	if (n < 0)
		(void)fprintf(stderr, "masspropd calc: %s: %s\n", file, strerror(errno));
	if (fd >= 0 && !standard)
		close(fd);
	return n < 0 ? -1 : 0;
}

static void print_table(const char *json, size_t len)
{
	char *table = api_report_table(json, len);

	(void)fputs(table != NULL ? table : json, stdout);
	free(table);
}

static int print(const struct calc *c, const char *file, const struct api_answer *a)
{
	if (a->status == 200 || c->json) {
		if (c->json)
			(void)printf("%s\n", a->body);
		else
			print_table(a->body, a->len);
	}
	if (a->status == 200)
		return GOOD;
	if (c->together) /* the detail says which file */
		(void)fprintf(stderr, "masspropd calc: %s\n", a->detail);
	else
		(void)fprintf(stderr, "masspropd calc: %s: %s\n", file, a->detail);
	return a->code == API_NOT_A_SOLID ? NOT_SOLID : UNREADABLE;
}

/* What the report calls a file; standard input has no name. */
static const char *shown_name(const char *file)
{
	const char *slash = strrchr(file, '/');

	if (strcmp(file, "-") == 0)
		return NULL;
	return slash != NULL ? slash + 1 : file;
}

/* One report, of ${count} files. */
static int one_solid(const struct calc *c, char **file, int count)
{
	struct api_job_head head = {.query = c->query,
				    .query_len = c->query_len,
				    .filename = shown_name(file[0]),
				    .several = c->together,
				    .instance = "calc",
				    .request_id = "calc",
				    .limits = {UINT64_MAX, 1400000000},
				    .second = c->second,
				    .now = srv_now};
	int verdict = UNREADABLE, i = 0;
	struct api_job *job;
	struct api_answer answer;
	double began = srv_now();

	(void)!getrandom(head.key, sizeof head.key, 0);
	job = api_job_new(&head);
	if (job == NULL) {
		(void)fprintf(stderr, "masspropd calc: %s: %s\n", file[0], strerror(errno));
		return UNREADABLE;
	}
	for (; i < count; i++)
		if ((i > 0 && api_job_next_file(job, shown_name(file[i])) != 0) ||
		    feed(job, file[i]) != 0)
			break;
	if (i == count || api_job_push(job, NULL, 0) != 0) { /* no file that cannot be read */
		api_job_answer(job, 1e3 * (srv_now() - began), 0, &answer);
		verdict = print(c, file[0], &answer);
		api_answer_free(&answer);
	}
	api_job_free(job);
	return verdict;
}

/* Options are judged once and by name; with --json the report of each file says it. */
static bool bad_option(const struct calc *c)
{
	struct api_job_head head = {.query = c->query, .query_len = c->query_len};
	struct api_problem p;

	if (c->json || api_job_precheck(&head, &p) == 0)
		return false;
	(void)fprintf(stderr, "masspropd calc: %s%s%s%s\n", p.option[0] != '\0' ? "--" : "",
		      p.option, p.option[0] != '\0' ? ": " : "", p.detail);
	return true;
}

/* The files move to the front of ${argv}.  0: compute; 1: help was wanted; -1: misuse. */
static int read_arguments(struct calc *c, int argc, char **argv)
{
	for (int i = 1; i < argc; i++) {
		if (strcmp(argv[i], "--help") == 0) {
			help();
			return 1;
		}
		if (strncmp(argv[i], "--", 2) != 0)
			argv[1 + c->files++] = argv[i];
		else if (flag(c, argc, argv, &i) != 0)
			return -1;
	}
	if (c->files > 0)
		return bad_option(c) ? -1 : 0;
	(void)fputs("masspropd calc: no file given (see masspropd calc --help)\n", stderr);
	return -1;
}

int srv_calc_main(int argc, char **argv)
{
	struct calc c = {.json = false};
	static struct srv_second second; /* its thread ends with the process */
	int rc = read_arguments(&c, argc, argv), worst = rc < 0 ? UNREADABLE : GOOD;

	if (rc == 0 && srv_second_start(&second, SRV_SANDBOX_OFF) > 0)
		c.second = &second.lent;
	for (int i = 1; rc == 0 && i <= c.files; i += c.together ? c.files : 1) {
		int verdict = one_solid(&c, argv + i, c.together ? c.files : 1);

		worst = verdict > worst ? verdict : worst;
	}
	free(c.query);
	return fflush(stdout) == 0 ? worst : UNREADABLE;
}
