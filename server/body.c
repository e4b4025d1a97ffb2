#include "server/body.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/io.h"

void srv_body_init(struct srv_body *b, struct srv_budget *budget)
{
	memset(b, 0, sizeof *b);
	b->budget = budget;
	b->fd = -1;
}

uint64_t srv_budget_left(const struct srv_budget *b)
{
	return b->used < b->most ? b->most - b->used : 0;
}

static int charge(struct srv_body *b, uint64_t bytes)
{
	if (bytes > srv_budget_left(b->budget))
		return -1;
	b->budget->used += bytes;
	if (b->budget->used > b->budget->highest)
		b->budget->highest = b->budget->used;
	b->charged += bytes;
	return 0;
}

static int to_file(struct srv_body *b, const uint8_t *bytes, size_t len)
{
	if (charge(b, len) != 0)
		return -1;
	if (b->fd < 0) {
		b->fd = memfd_create("body", MFD_CLOEXEC);
		if (b->fd < 0 || srv_write_all(b->fd, b->bytes, b->len) != 0)
			return -1;
		b->spooled = b->len;
		free(b->bytes);
		b->bytes = NULL;
		b->size = 0;
	}
	if (srv_write_all(b->fd, bytes, len) != 0)
		return -1;
	b->spooled += len;
	return 0;
}

int srv_body_add(struct srv_body *b, const uint8_t *bytes, size_t len)
{
	size_t size = b->size == 0 ? 1024 : b->size;
	uint8_t *grown;

	if (b->fd >= 0 || b->len + len > SRV_BODY_SMALL)
		return to_file(b, bytes, len);
	while (size < b->len + len)
		size *= 2;
	if (size > b->size) {
		if (charge(b, size - b->size) != 0)
			return -1;
		grown = realloc(b->bytes, size);
		if (grown == NULL)
			return -1;
		b->bytes = grown;
		b->size = size;
	}
	memcpy(b->bytes + b->len, bytes, len);
	b->len += len;
	return 0;
}

bool srv_body_fits(const struct srv_body *b)
{
	return srv_budget_left(b->budget) >= SRV_BODY_SMALL;
}

void srv_body_clear(struct srv_body *b)
{
	free(b->bytes);
	if (b->fd >= 0)
		close(b->fd);
	b->budget->used -= b->charged;
	srv_body_init(b, b->budget);
}
