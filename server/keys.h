#ifndef SRV_KEYS_H
#define SRV_KEYS_H

#include <stdbool.h>
#include <stddef.h>

/*
 * API keys: a file with a key a line, behind # a comment.  The master reads the file (again on
 * SIGHUP) and keeps nothing of it but a sealed memfd, which only the front gets: a worker that a
 * stranger's file took over finds no key in its memory.
 */

enum { SRV_KEY_MAX = 255, SRV_KEYS_MAX = 1000 };

/* All 0: no keys are in force. */
struct srv_keys {
	bool in_force;
	char (*key)[SRV_KEY_MAX + 1]; /* zero-padded: what is compared is all of it */
	unsigned count;
};

/*
 * The keys of the file at ${path} as a memfd, a line each.  -1 with one line in ${why}: the file
 * cannot be read, is no plain file, holds a key that is longer than SRV_KEY_MAX or not of visible
 * ASCII without blanks, or more than SRV_KEYS_MAX keys, or none at all (that would lock out
 * everybody).  ${why} never quotes a key.
 */
int srv_keys_read(const char *path, char *why, size_t size);

/* Take the keys of such a memfd into force; 0, or -1 with those before still in force. */
int srv_keys_load(struct srv_keys *, int memfd);
void srv_keys_free(struct srv_keys *);

/*
 * Does ${authorization} (the value of that header, NULL for none) bear one of the keys (RFC 6750:
 * "Bearer KEY")?  Every key is compared to its end, so that time tells nothing but their number.
 */
bool srv_keys_fit(const struct srv_keys *, const char *authorization);

#endif
