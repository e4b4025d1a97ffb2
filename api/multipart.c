#include "api/multipart.h"

#include <inttypes.h>
#include <stdbool.h>
#include <string.h>

enum state {
	CONTENT, /* of a part, or in front of the first; in a delimiter where matched > 0 */
	TAIL,    /* the delimiter came whole: what follows decides */
	DASH,    /* delimiter and - */
	TAIL_CR, /* delimiter and CR */
	PAD,     /* delimiter and blanks */
	PAD_CR,
	HEAD,
	EPILOGUE
};

void api_multipart_begin(struct api_multipart *m, const char *boundary,
			 const struct api_multipart_sink *sink)
{
	size_t len = strlen(boundary);

	memset(m, 0, sizeof *m);
	m->sink = *sink;
	memcpy(m->delimiter, "\r\n--", 4);
	memcpy(m->delimiter + 4, boundary, len);
	m->delimiter_len = 4 + len;
	m->state = CONTENT;
	m->matched = m->ghost = 2; /* the first boundary may be the first line */
}

static int bad(const struct api_multipart *m, struct api_problem *p, uint64_t at, const char *what)
{
	if (m->parts > 0)
		(void)api_problem_set(p, API_BAD_MULTIPART, "Part %zu of the form: %s.", m->parts,
				      what);
	else
		(void)api_problem_set(p, API_BAD_MULTIPART, "The form: %s.", what);
	p->byte = at;
	return -1;
}

static int emit(struct api_multipart *m, const uint8_t *bytes, size_t len, struct api_problem *p)
{
	if (m->parts == 0 || len == 0)
		return 0;
	return m->sink.bytes(m->sink.self, bytes, len, p);
}

/* What was read as the beginning of a delimiter, or as a whole one, is data. */
static int emit_matched(struct api_multipart *m, struct api_problem *p)
{
	size_t ghost = m->ghost, len = m->matched - ghost;

	m->matched = m->ghost = 0;
	m->state = CONTENT;
	return emit(m, (const uint8_t *)m->delimiter + ghost, len, p);
}

/*
 * Go on with what may be a delimiter.  Where it fails, another can only begin
 * with the byte that did not fit: there is one CR in a delimiter, its first byte.
 */
static int match_on(struct api_multipart *m, const uint8_t *bytes, size_t len, size_t *taken,
		    struct api_problem *p)
{
	size_t n = 0;

	while (n < len && m->matched < m->delimiter_len &&
	       bytes[n] == (uint8_t)m->delimiter[m->matched]) {
		m->matched++;
		n++;
	}
	*taken = n;
	if (m->matched == m->delimiter_len)
		m->state = TAIL;
	else if (n < len)
		return emit_matched(m, p);
	return 0;
}

/* Data up to the next delimiter, or what may be the beginning of one at the end of the chunk. */
static int content(struct api_multipart *m, const uint8_t *bytes, size_t len, size_t *taken,
		   struct api_problem *p)
{
	const uint8_t *from = bytes, *cr;

	if (m->matched > 0)
		return match_on(m, bytes, len, taken, p);
	while ((cr = memchr(from, '\r', len - (size_t)(from - bytes))) != NULL) {
		size_t left = len - (size_t)(cr - bytes);
		size_t n = left < m->delimiter_len ? left : m->delimiter_len;

		if (memcmp(cr, m->delimiter, n) == 0) {
			m->matched = n;
			*taken = (size_t)(cr - bytes) + n;
			return emit(m, bytes, (size_t)(cr - bytes), p);
		}
		from = cr + 1;
	}
	*taken = len;
	return emit(m, bytes, len, p);
}

static int end_part(struct api_multipart *m, struct api_problem *p)
{
	return m->parts > 0 ? m->sink.end(m->sink.self, p) : 0;
}

/* The line of the delimiter is over: the part before it is, too. */
static int next_part(struct api_multipart *m, struct api_problem *p)
{
	if (end_part(m, p))
		return -1;
	if (m->parts == API_MULTIPART_PARTS) {
		(void)api_problem_set(p, API_BAD_MULTIPART, "The form has more than %d parts.",
				      API_MULTIPART_PARTS);
		p->limit = API_MULTIPART_PARTS;
		p->actual = m->parts + 1;
		return -1;
	}
	m->parts++;
	m->matched = m->ghost = m->head_len = 0;
	m->state = HEAD;
	return 0;
}

/* A byte behind the delimiter.  ${*taken} 0: it is to be looked at again. */
static int tail(struct api_multipart *m, uint8_t byte, size_t *taken, struct api_problem *p)
{
	static const uint8_t held[] = "-\r";
	bool cr = m->state == TAIL_CR || m->state == PAD_CR, dash = m->state == DASH;
	bool padded = m->state == PAD || m->state == PAD_CR;

	*taken = 1;
	if (cr && byte == '\n')
		return next_part(m, p);
	if (dash && byte == '-') {
		m->state = EPILOGUE;
		return end_part(m, p);
	}
	if (!cr && !dash && byte == '\n')
		return bad(m, p, m->at, "its lines end with LF alone; they have to end with CRLF");
	if (!cr && !dash && byte == '\r') {
		m->state = padded ? PAD_CR : TAIL_CR;
		return 0;
	}
	if (!cr && !dash && (byte == ' ' || byte == '\t')) {
		m->state = PAD;
		return 0;
	}
	if (padded)
		return bad(m, p, m->at, "a boundary has something else behind it on its line");
	if (m->state == TAIL && byte == '-') {
		m->state = DASH;
		return 0;
	}
	*taken = 0;
	return emit_matched(m, p) || ((cr || dash) && emit(m, held + cr, 1, p)) ? -1 : 0;
}

static int begin_part(struct api_multipart *m, struct api_problem *p)
{
	const char *wrong = api_part_read(m->head, m->head_len, &m->part);

	if (wrong != NULL)
		return bad(m, p, m->at, wrong);
	m->state = CONTENT;
	m->matched = m->ghost = 2; /* an empty part: the empty line ends its head and it */
	return m->sink.begin(m->sink.self, &m->part, p);
}

static int head(struct api_multipart *m, uint8_t byte, struct api_problem *p)
{
	size_t n = m->head_len;
	bool after_cr = n > 0 && m->head[n - 1] == '\r';

	if (n == sizeof m->head)
		return bad(m, p, m->at, "its head is longer than 8192 bytes");
	if ((byte == '\n') != after_cr)
		return bad(m, p, m->at, "a line of its head does not end with CRLF");
	if ((byte < 0x20 && byte != '\t' && byte != '\r' && byte != '\n') || byte == 0x7f)
		return bad(m, p, m->at, "its head has a control character");
	m->head[n++] = (char)byte;
	m->head_len = n;
	if (byte != '\n' || (n != 2 && m->head[n - 3] != '\n')) /* no LF without a CR is in it */
		return 0;
	return begin_part(m, p);
}

int api_multipart_push(struct api_multipart *m, const uint8_t *bytes, size_t len,
		       struct api_problem *p)
{
	while (len > 0 && m->state != EPILOGUE) {
		size_t taken = 1;
		int rc;

		if (m->state == CONTENT)
			rc = content(m, bytes, len, &taken, p);
		else if (m->state == HEAD)
			rc = head(m, *bytes, p);
		else
			rc = tail(m, *bytes, &taken, p);
		if (rc)
			return -1;
		bytes += taken;
		len -= taken;
		m->at += taken;
	}
	return 0;
}

int api_multipart_finish(struct api_multipart *m, struct api_problem *p)
{
	if (m->state == EPILOGUE)
		return 0;
	if (m->at == 0)
		return bad(m, p, 0, "the body is empty");
	if (m->parts == 0)
		return bad(m, p, m->at,
			   "the boundary of Content-Type does not occur at the beginning of a "
			   "line");
	return bad(m, p, m->at, "the body ends in it, without a last boundary");
}
