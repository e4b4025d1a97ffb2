#include "server/log.h"

#include <limits.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static struct {
	enum srv_level most;
	bool json;
	const char *role;
} log_state = {SRV_INFO, false, "masspropd"};

static const char *const level_name[] = {"error", "warn", "info", "debug"};

void srv_log_setup(enum srv_level most, bool json, const char *role)
{
	log_state.most = most;
	log_state.json = json;
	log_state.role = role;
}

void srv_log_role(const char *role)
{
	log_state.role = role;
}

bool srv_log_wants(enum srv_level level)
{
	return level <= log_state.most;
}

/* Copy ${s} so that it can stand inside quotes in JSON and text alike: printable ASCII only. */
static const char *escape(const char *s, char *out, size_t size)
{
	static const char hex[] = "0123456789abcdef";
	size_t n = 0;

	for (; s != NULL && *s != '\0' && n + 7 < size; s++) {
		unsigned char c = (unsigned char)*s;

		if (c < 0x20 || c > 0x7e || c == '"' || c == '\\') {
			memcpy(out + n, "\\u00", 4);
			out[n + 4] = hex[c >> 4];
			out[n + 5] = hex[c & 15];
			n += 6;
		} else {
			out[n++] = (char)c;
		}
	}
	out[n] = '\0';
	return out;
}

static void stamp(char out[40])
{
	struct timespec ts;
	struct tm tm;
	size_t n;

	clock_gettime(CLOCK_REALTIME, &ts);
	gmtime_r(&ts.tv_sec, &tm);
	n = strftime(out, 40, "%Y-%m-%dT%H:%M:%S", &tm);
	(void)snprintf(out + n, 40 - n, ".%03ldZ", ts.tv_nsec / 1000000);
}

/* Whole lines, and not more of them than a pipe takes at once: others write to it, too. */
static struct {
	char lines[PIPE_BUF];
	size_t len;
} held;

void srv_log_flush(void)
{
	struct pollfd log = {.fd = STDERR_FILENO, .events = POLLOUT};
	const char *at = held.lines;

	/* A log that nobody reads must not stop the service: a full pipe loses lines. */
	while (held.len > 0 && poll(&log, 1, 0) != 0) {
		ssize_t put = write(STDERR_FILENO, at, held.len);

		if (put <= 0)
			break;
		at += put;
		held.len -= (size_t)put;
	}
	held.len = 0;
}

static void hold(char *line, int n, size_t size)
{
	size_t len = n < 0 ? 0 : (size_t)n < size - 1 ? (size_t)n : size - 2;

	line[len++] = '\n';
	if (len > sizeof held.lines - held.len)
		srv_log_flush();
	memcpy(held.lines + held.len, line, len);
	held.len += len;
}

void srv_log(enum srv_level level, const char *fmt, ...)
{
	char text[512], safe[1024], when[40], line[1400];
	va_list ap;
	int n;

	if (!srv_log_wants(level))
		return;
	va_start(ap, fmt);
	(void)vsnprintf(text, sizeof text, fmt, ap);
	va_end(ap);
	stamp(when);
	n = log_state.json
		? snprintf(line, sizeof line,
			   "{\"time\":\"%s\",\"level\":\"%s\",\"role\":\"%s\",\"message\":\"%s\"}",
			   when, level_name[level], log_state.role, escape(text, safe, sizeof safe))
		: snprintf(line, sizeof line, "%s %s %s: %s", when, level_name[level],
			   log_state.role, escape(text, safe, sizeof safe));
	hold(line, n, sizeof line);
	srv_log_flush();
}

void srv_log_access(const struct srv_access *a)
{
	char path[300], method[80], id[80], when[40], line[1200];
	int n;

	if (!srv_log_wants(SRV_INFO))
		return;
	stamp(when);
	escape(a->path, path, sizeof path);
	escape(a->method, method, sizeof method);
	escape(a->id, id, sizeof id);
	if (log_state.json)
		n = snprintf(
		    line, sizeof line,
		    "{\"time\":\"%s\",\"level\":\"info\",\"role\":\"%s\",\"request_id\":\"%s\","
		    "\"client\":\"%s\",\"method\":\"%s\",\"path\":\"%s\",\"status\":%d,"
		    "\"code\":\"%s\",\"format\":\"%s\",\"received\":%llu,\"sent\":%llu,"
		    "\"ms\":%.3f}",
		    when, log_state.role, id, a->client, method, path, a->status, a->code,
		    a->format, a->received, a->sent, 1e3 * a->seconds);
	else
		n = snprintf(
		    line, sizeof line,
		    "%s info %s: %s %s %s %d%s%s%s%s received=%llu sent=%llu ms=%.3f id=%s", when,
		    log_state.role, a->client, method, path, a->status, *a->code ? " " : "",
		    a->code, *a->format ? " format=" : "", a->format, a->received, a->sent,
		    1e3 * a->seconds, id);
	hold(line, n, sizeof line);
}
