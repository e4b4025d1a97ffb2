#include "server/config.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/config_value.h"

extern char **environ;

enum kind { LIST_LISTEN, LIST_ORIGIN, TEXT, SIZE, DURATION, COUNT, LEVEL, FORMAT, SANDBOX };

struct row {
	const char *name, *fallback, *help;
	const char *shown; /* for --help where fallback is NULL: the default is found out */
	enum kind kind;
	size_t offset;
	double least, most;
};

#define AT(field) offsetof(struct srv_config, field)

/* Every setting: the flag is --NAME VALUE, the variable MASSPROPD_NAME. */
static const struct row rows[] = {
    {"listen", "127.0.0.1:8080", "ADDRESS:PORT to serve on, several by commas; port 0 picks one",
     NULL, LIST_LISTEN, 0, 0, 0},
    {"workers", NULL, "processes for bodies of any size; one more is kept for small ones",
     "the number of cores", COUNT, AT(workers), 1, 256},
    {"queue", NULL, "requests that may wait for a worker, large and small ones each",
     "4 (large) and 64 (small) times the workers", COUNT, AT(queue), 1, 1e6},
    {"max-body", "1GiB", "largest request body as sent", NULL, SIZE, AT(max_body), 1, 1e15},
    {"max-decoded", "4GiB", "largest file after content decoding", NULL, SIZE, AT(max_decoded), 1,
     1e15},
    {"max-triangles", "20M", "most triangles of one mesh", NULL, COUNT, AT(max_triangles), 1,
     1.4e9},
    {"memory", NULL, "memory for workers and waiting bodies",
     "80 % of what the machine or the container has", SIZE, AT(memory), 64e6, 1e16},
    {"header-timeout", "10s", "for a client to send the head of a request", NULL, DURATION,
     AT(header_timeout), 0.01, 86400},
    {"body-timeout", "60s", "for a body to stay below 64 kB/s", NULL, DURATION, AT(body_timeout),
     0.01, 86400},
    {"deadline", "30s", "for the work on one request, waiting apart", NULL, DURATION, AT(deadline),
     0.01, 86400},
    {"write-timeout", "60s", "for a client to take its answer, again for every 4 MB of it", NULL,
     DURATION, AT(write_timeout), 0.01, 86400},
    {"drain-delay", "0s", "after SIGTERM: still serving, already unready", NULL, DURATION,
     AT(drain_delay), 0, 86400},
    {"drain-timeout", "25s", "after that: for work in flight to be finished", NULL, DURATION,
     AT(drain_timeout), 0, 86400},
    {"cors-origin", NULL, "origins that browsers may call from: exact, *.suffix or *, by commas",
     "none", LIST_ORIGIN, 0, 0, 0},
    {"api-key-file", NULL, "keys that clients have to send, one a line; read again on SIGHUP",
     "none: everybody may ask", TEXT, AT(api_key_file), 0, 0},
    {"metrics-listen", NULL, "ADDRESS:PORT that serves /metrics and the probes, without keys",
     "none: /metrics is served with the rest", TEXT, AT(metrics_listen), 0, 0},
    {"sandbox", "auto", "seccomp and Landlock: auto (what the kernel has), require or off", NULL,
     SANDBOX, 0, 0, 0},
    {"log-format", "text", "text or json", NULL, FORMAT, 0, 0, 0},
    {"log-level", "info", "error, warn, info or debug", NULL, LEVEL, 0, 0, 0},
};

enum { ROWS = sizeof rows / sizeof rows[0] };

struct srv_config_text {
	struct srv_config_text *next;
	char text[];
};

/* A copy that the config owns. */
static char *keep(struct srv_config *c, const char *text)
{
	size_t size = strlen(text) + 1;
	struct srv_config_text *t = malloc(sizeof *t + size);

	if (t == NULL)
		return NULL;
	memcpy(t->text, text, size);
	t->next = c->texts;
	c->texts = t;
	return t->text;
}

void srv_config_free(struct srv_config *c)
{
	while (c->texts != NULL) {
		struct srv_config_text *next = c->texts->next;

		free(c->texts);
		c->texts = next;
	}
}

/* The items of ${text}; behind those that are there where the same flag came before. */
static int list(struct srv_config *c, const char *text, const char **items, unsigned *count,
		unsigned most, bool append)
{
	char *copy = keep(c, text), *save = NULL, *item;

	if (copy == NULL)
		return -1;
	if (!append)
		*count = 0;
	for (item = strtok_r(copy, ",", &save); item != NULL; item = strtok_r(NULL, ",", &save)) {
		if (*count == most)
			return -1;
		items[(*count)++] = item;
	}
	return *count > 0 ? 0 : -1;
}

static int word(const char *text, const char *const *words)
{
	for (int i = 0; words[i] != NULL; i++)
		if (strcmp(text, words[i]) == 0)
			return i;
	return -1;
}

static int set_number(struct srv_config *c, const struct row *row, const char *text)
{
	uint64_t whole = 0;
	double value = 0;

	if (row->kind == DURATION) {
		if (srv_value_duration(text, &value) != 0)
			return -1;
	} else {
		if ((row->kind == SIZE ? srv_value_size : srv_value_count)(text, &whole) != 0)
			return -1;
		value = (double)whole;
	}
	if (value < row->least || value > row->most)
		return -1;
	if (row->kind == DURATION)
		memcpy((char *)c + row->offset, &value, sizeof value);
	else
		memcpy((char *)c + row->offset, &whole, sizeof whole);
	return 0;
}

/* A name: the last one counts. */
static int set_text(struct srv_config *c, const struct row *row, const char *text)
{
	const char *copy = *text != '\0' ? keep(c, text) : NULL;

	memcpy((char *)c + row->offset, &copy, sizeof copy);
	return copy != NULL ? 0 : -1;
}

static int set(struct srv_config *c, const struct row *row, const char *text, bool again)
{
	static const char *const levels[] = {"error", "warn", "info", "debug", NULL};
	static const char *const formats[] = {"text", "json", NULL};
	static const char *const modes[] = {"auto", "require", "off", NULL};
	int i;

	switch (row->kind) {
	case LIST_LISTEN:
		return list(c, text, c->listen, &c->listens, SRV_LISTEN_MAX, again);
	case LIST_ORIGIN:
		return list(c, text, c->origin, &c->origins, SRV_ORIGIN_MAX, again);
	case TEXT:
		return set_text(c, row, text);
	case LEVEL:
		if ((i = word(text, levels)) < 0)
			return -1;
		c->log_level = (enum srv_level)i;
		return 0;
	case FORMAT:
		if ((i = word(text, formats)) < 0)
			return -1;
		c->log_json = i == 1;
		return 0;
	case SANDBOX:
		if ((i = word(text, modes)) < 0)
			return -1;
		c->sandbox = (enum srv_sandbox_mode)i;
		return 0;
	case SIZE:
	case DURATION:
	case COUNT:
		break;
	}
	return set_number(c, row, text);
}

static const struct row *find(const char *name, size_t len)
{
	for (size_t i = 0; i < ROWS; i++)
		if (strlen(rows[i].name) == len && memcmp(rows[i].name, name, len) == 0)
			return &rows[i];
	return NULL;
}

/* MASSPROPD_MAX_BODY -> max-body */
static int from_environment(struct srv_config *c, char *why, size_t size)
{
	static const char prefix[] = "MASSPROPD_";
	const size_t skip = sizeof prefix - 1;

	for (char **e = environ; *e != NULL; e++) {
		const char *equals = strchr(*e, '=');
		const struct row *row = NULL;
		char name[64] = "";
		size_t len;

		if (strncmp(*e, prefix, skip) != 0 || equals == NULL)
			continue;
		len = (size_t)(equals - *e) - skip;
		if (len < sizeof name) {
			for (size_t i = 0; i < len; i++) {
				unsigned char ch = (unsigned char)(*e)[skip + i];

				name[i] = ch == '_' ? '-' : islower(ch) ? '?' : (char)tolower(ch);
			}
			row = find(name, len);
		}
		if (row == NULL || set(c, row, equals + 1, false) != 0) {
			(void)snprintf(why, size, "%s %.*s",
				       row == NULL ? "unknown environment variable"
						   : "not a value for",
				       (int)(equals - *e), *e);
			return -1;
		}
	}
	return 0;
}

/* The flag at argv[*at]; ${seen} has a bit for each row that an earlier flag set. */
static int one_flag(struct srv_config *c, int argc, char **argv, int *at, uint32_t *seen, char *why,
		    size_t size)
{
	static const char *const plain[] = {"--help", "--version", "--health", NULL};
	const char *arg = argv[*at], *equals = strchr(arg, '='), *value;
	bool *const flags[] = {&c->help, &c->version, &c->health};
	const struct row *row;
	int i = word(arg, plain);

	if (i >= 0) {
		*flags[i] = true;
		return 0;
	}
	row = strncmp(arg, "--", 2) != 0
		  ? NULL
		  : find(arg + 2, equals != NULL ? (size_t)(equals - arg) - 2 : strlen(arg + 2));
	if (row == NULL) {
		(void)snprintf(why, size, "unknown argument %.80s (see --help)", arg);
		return -1;
	}
	value = equals != NULL ? equals + 1 : *at + 1 < argc ? argv[++*at] : NULL;
	if (value == NULL || set(c, row, value, (*seen >> (row - rows) & 1) != 0) != 0) {
		(void)snprintf(why, size,
			       value == NULL ? "--%s needs a value" : "--%s: not a value: %.80s",
			       row->name, value == NULL ? "" : value);
		return -1;
	}
	*seen |= 1u << (row - rows);
	return 0;
}

int srv_config_load(struct srv_config *c, int argc, char **argv, char *why, size_t size)
{
	long cores = sysconf(_SC_NPROCESSORS_ONLN);
	uint32_t seen = 0;

	memset(c, 0, sizeof *c);
	(void)snprintf(why, size, "out of memory");
	c->workers = cores < 1 ? 1 : cores > 64 ? 64 : (uint64_t)cores;
	c->log_level = SRV_INFO;
	for (size_t i = 0; i < ROWS; i++)
		if (rows[i].fallback != NULL && set(c, &rows[i], rows[i].fallback, false) != 0)
			return -1; /* no memory: the table's own values are sound */
	if (from_environment(c, why, size) != 0)
		return -1;
	for (int i = 1; i < argc; i++)
		if (one_flag(c, argc, argv, &i, &seen, why, size) != 0)
			return -1;
	return 0;
}

void srv_config_help(void)
{
	(void)puts(
	    "usage: masspropd [FLAGS]                 serve\n"
	    "       masspropd calc [OPTIONS] FILE...  compute without a server (calc --help)\n"
	    "       masspropd --health                ask a running daemon, exit 0 or 1\n"
	    "       masspropd --help | --version\n\n"
	    "flags (each also as an environment variable, --max-body as MASSPROPD_MAX_BODY):");
	for (size_t i = 0; i < ROWS; i++)
		(void)printf("  --%-16s %s (default: %s)\n", rows[i].name, rows[i].help,
			     rows[i].fallback != NULL ? rows[i].fallback : rows[i].shown);
	(void)puts("\nsizes take B kB MB GB KiB MiB GiB, durations ms s min h, counts k M");
}
