#ifndef SRV_ROUTE_H
#define SRV_ROUTE_H

#include "server/config.h"
#include "server/exchange.h"

/*
 * What the head of a request decides: is it well-formed, whose is it, may it go on?  Fills
 * ex->endpoint, ex->id, ex->origin and the answer where one is known already.
 */
void srv_route_head(struct srv_exchange *ex, const struct srv_head *head);

/*
 * Shapes that must not be believed (request smuggling, absurd lengths, control bytes): the
 * reason in one clause, or NULL for a sound head.  ${length}: the Content-Length, API_NONE for
 * none.
 */
const char *srv_guard_judge(const struct srv_head *head, uint64_t *length);

/*
 * Is a header field sound?  A name is a token (RFC 9110, 5.6.2), a value has no control bytes.
 * libmicrohttpd 0.9 makes "Content-Length5" of a Content-Length that is folded onto a second line:
 * names that begin like that would hide where a body ends and are refused.
 */
bool srv_guard_field(const char *name, const char *value);

/* Does one of the configured origins (exact, *.suffix, *) cover ${origin}? */
bool srv_cors_allows(const struct srv_config *config, const char *origin);

/* Does an Accept header (NULL: none) take application/json? */
bool srv_accept_json(const char *accept);

/* The same for model/stl. */
bool srv_accept_stl(const char *accept);

#endif
