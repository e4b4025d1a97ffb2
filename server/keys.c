#include "server/keys.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/io.h"

enum { FILE_MAX = 1 << 20 };

struct text {
	char *bytes;
	size_t len;
};

static void forget(struct text *t)
{
	if (t->bytes != NULL)
		explicit_bzero(t->bytes, t->len);
	free(t->bytes);
	*t = (struct text){NULL, 0};
}

/* All of ${fd} from its beginning, at most ${most} bytes; 0 or -1 with errno. */
static int read_all(int fd, size_t most, struct text *t)
{
	t->len = 0;
	t->bytes = malloc(most + 1);
	while (t->bytes != NULL && t->len <= most) {
		ssize_t n = pread(fd, t->bytes + t->len, most + 1 - t->len, (off_t)t->len);

		if (n == 0)
			return 0;
		if (n > 0)
			t->len += (size_t)n;
		else if (errno != EINTR)
			break;
	}
	if (t->bytes == NULL)
		errno = ENOMEM;
	else if (t->len > most)
		errno = EFBIG;
	return -1;
}

static bool blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r';
}

/* The key in a line, without its blanks and comment. */
static struct text trim(char *line, size_t len)
{
	char *end = line;

	while (end < line + len && !(*end == '#' && (end == line || blank(end[-1]))))
		end++;
	while (line < end && blank(*line))
		line++;
	while (line < end && blank(end[-1]))
		end--;
	return (struct text){line, (size_t)(end - line)};
}

static const char *key_fault(const struct text *key)
{
	if (key->len > SRV_KEY_MAX)
		return "the key is longer than 255 characters";
	for (size_t i = 0; i < key->len; i++)
		if (key->bytes[i] <= ' ' || key->bytes[i] > '~')
			return "a key is of visible ASCII characters, one a line";
	return NULL;
}

/* Move the keys to the front of ${t}, a line each; their number, or -1. */
static int gather(struct text *t, const char *path, char *why, size_t size)
{
	char *out = t->bytes, *end = t->bytes + t->len, *next;
	int count = 0, number = 0;

	for (char *line = t->bytes; line < end; line = next) {
		char *newline = memchr(line, '\n', (size_t)(end - line));
		struct text key;
		const char *fault;

		next = newline != NULL ? newline + 1 : end;
		number++;
		key = trim(line, (size_t)(next - line) - (newline != NULL));
		fault = key_fault(&key);
		if (fault == NULL && key.len > 0 && ++count > SRV_KEYS_MAX)
			fault = "more than 1000 keys";
		if (fault != NULL) {
			(void)snprintf(why, size, "%s:%d: %s", path, number, fault);
			return -1;
		}
		if (key.len == 0)
			continue;
		memmove(out, key.bytes, key.len);
		out += key.len;
		*out++ = '\n'; /* its own line's, or the byte that read_all() keeps free */
	}
	if (count == 0)
		(void)snprintf(why, size, "%s: no key in it", path);
	if (count == 0)
		return -1;
	t->len = (size_t)(out - t->bytes);
	return count;
}

static int seal(const struct text *t)
{
	int fd = memfd_create("masspropd-keys", MFD_CLOEXEC | MFD_ALLOW_SEALING);

	if (fd < 0)
		return -1;
	if (srv_write_all(fd, t->bytes, t->len) == 0 &&
	    fcntl(fd, F_ADD_SEALS, F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE) == 0)
		return fd;
	close(fd);
	return -1;
}

int srv_keys_read(const char *path, char *why, size_t size)
{
	int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY), fd = -1;
	struct text t = {NULL, 0};
	struct stat st;

	(void)snprintf(why, size, "%s: %s", path, strerror(errno));
	if (file < 0)
		return -1;
	if (fstat(file, &st) != 0 || !S_ISREG(st.st_mode)) {
		(void)snprintf(why, size, "%s: not a plain file", path);
	} else if (read_all(file, FILE_MAX, &t) != 0) {
		(void)snprintf(why, size, "%s: %s", path, strerror(errno));
	} else if (gather(&t, path, why, size) > 0) {
		fd = seal(&t);
		if (fd < 0)
			(void)snprintf(why, size, "%s: no memory: %s", path, strerror(errno));
	}
	t.len = t.bytes != NULL ? FILE_MAX : 0;
	forget(&t);
	close(file);
	return fd;
}

int srv_keys_load(struct srv_keys *keys, int memfd)
{
	struct srv_keys fresh = {.in_force = true};
	struct text t;
	char *line, *newline;

	if (read_all(memfd, FILE_MAX, &t) == 0)
		fresh.key = calloc(SRV_KEYS_MAX, sizeof *fresh.key);
	for (line = t.bytes; fresh.key != NULL && line < t.bytes + t.len; line = newline + 1) {
		newline = memchr(line, '\n', (size_t)(t.bytes + t.len - line));
		if (newline == NULL || newline - line > SRV_KEY_MAX || fresh.count == SRV_KEYS_MAX)
			break;
		memcpy(fresh.key[fresh.count++], line, (size_t)(newline - line));
	}
	forget(&t);
	if (fresh.count == 0) {
		free(fresh.key);
		return -1;
	}
	srv_keys_free(keys);
	*keys = fresh;
	return 0;
}

void srv_keys_free(struct srv_keys *keys)
{
	if (keys->key != NULL)
		explicit_bzero(keys->key, SRV_KEYS_MAX * sizeof *keys->key);
	free(keys->key);
	memset(keys, 0, sizeof *keys);
}

bool srv_keys_fit(const struct srv_keys *keys, const char *authorization)
{
	static const char scheme[] = "Bearer ";
	char given[SRV_KEY_MAX + 1] = "";
	unsigned fit = 0;
	size_t len;

	if (authorization == NULL || strncasecmp(authorization, scheme, sizeof scheme - 1) != 0)
		return false;
	authorization += sizeof scheme - 1;
	authorization += strspn(authorization, " ");
	len = strlen(authorization);
	if (len == 0 || len > SRV_KEY_MAX)
		return false;
	memcpy(given, authorization, len);
	for (unsigned i = 0; i < keys->count; i++) {
		unsigned differs = 0;

		for (size_t k = 0; k < sizeof given; k++)
			differs |= (unsigned char)(given[k] ^ keys->key[i][k]);
		fit |= (differs - 1) >> 31; /* 1 where nothing differs, without a branch */
	}
	explicit_bzero(given, sizeof given);
	return fit != 0;
}
