#include "server/log.h"

#include <limits.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "server/line.h"

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

static const char *stamp(void)
{
	static time_t second; /* of what is in text: most lines come within one */
	static char text[40];
	struct timespec ts;
	struct srv_line l;
	struct tm tm;

	clock_gettime(CLOCK_REALTIME, &ts);
	if (ts.tv_sec != second || text[0] == '\0') {
		gmtime_r(&ts.tv_sec, &tm);
		(void)strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &tm);
		second = ts.tv_sec;
	}
	l = (struct srv_line){text, strcspn(text, "."), sizeof text};
	srv_line_say(&l, ".");
	srv_line_digits(&l, (uint64_t)ts.tv_nsec / 1000000, 3);
	srv_line_say(&l, "Z");
	return text;
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

static void hold(const char *line, size_t len)
{
	if (len + 1 > sizeof held.lines - held.len)
		srv_log_flush();
	memcpy(held.lines + held.len, line, len);
	held.lines[held.len + len] = '\n';
	held.len += len + 1;
}

/* Up to the first word that only this line has. */
static void begin(struct srv_line *l, enum srv_level level)
{
	srv_line_say(l, log_state.json ? "{\"time\":\"" : "");
	srv_line_say(l, stamp());
	srv_line_say(l, log_state.json ? "\",\"level\":\"" : " ");
	srv_line_say(l, level_name[level]);
	srv_line_say(l, log_state.json ? "\",\"role\":\"" : " ");
	srv_line_say(l, log_state.role);
}

void srv_log(enum srv_level level, const char *fmt, ...)
{
	char text[512], safe[1024], line[1400];
	struct srv_line l = SRV_LINE(line);
	va_list ap;

	if (!srv_log_wants(level))
		return;
	va_start(ap, fmt);
	(void)vsnprintf(text, sizeof text, fmt, ap);
	va_end(ap);
	begin(&l, level);
	srv_line_say(&l, log_state.json ? "\",\"message\":\"" : ": ");
	srv_line_say(&l, escape(text, safe, sizeof safe));
	srv_line_say(&l, log_state.json ? "\"}" : "");
	hold(line, l.len);
	srv_log_flush();
}

static void say_pair(struct srv_line *l, const char *name, const char *value)
{
	srv_line_say(l, name);
	srv_line_say(l, value);
}

static void say_sizes(struct srv_line *l, const struct srv_access *a)
{
	srv_line_say(l, log_state.json ? ",\"received\":" : " received=");
	srv_line_count(l, a->received);
	srv_line_say(l, log_state.json ? ",\"sent\":" : " sent=");
	srv_line_count(l, a->sent);
	srv_line_say(l, log_state.json ? ",\"ms\":" : " ms=");
	srv_line_thousandths(l, 1e3 * a->seconds);
}

void srv_log_access(const struct srv_access *a)
{
	char path[300], method[80], id[80], line[1200];
	struct srv_line l = SRV_LINE(line);

	if (!srv_log_wants(SRV_INFO))
		return;
	escape(a->path, path, sizeof path);
	escape(a->method, method, sizeof method);
	escape(a->id, id, sizeof id);
	begin(&l, SRV_INFO);
	if (log_state.json) {
		say_pair(&l, "\",\"request_id\":\"", id);
		say_pair(&l, "\",\"client\":\"", a->client);
		say_pair(&l, "\",\"method\":\"", method);
		say_pair(&l, "\",\"path\":\"", path);
		srv_line_say(&l, "\",\"status\":");
		srv_line_count(&l, (uint64_t)a->status);
		say_pair(&l, ",\"code\":\"", a->code);
		say_pair(&l, "\",\"format\":\"", a->format);
		srv_line_say(&l, "\"");
		say_sizes(&l, a);
		srv_line_say(&l, "}");
	} else {
		say_pair(&l, ": ", a->client);
		say_pair(&l, " ", method);
		say_pair(&l, " ", path);
		srv_line_say(&l, " ");
		srv_line_count(&l, (uint64_t)a->status);
		say_pair(&l, *a->code != '\0' ? " " : "", a->code);
		say_pair(&l, *a->format != '\0' ? " format=" : "", a->format);
		say_sizes(&l, a);
		say_pair(&l, " id=", id);
	}
	hold(line, l.len);
}
