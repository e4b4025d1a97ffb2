#ifndef MP_RING_KERNEL_H
#define MP_RING_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * Private to manifold.c and its parts: is there one ring of triangles around each vertex?  In
 * copies for what the processor can do, which say the same.  A corner of a vertex links the vertex
 * for which its triangle leaves to the one from which it comes back; a line of the cache has the
 * first links of a vertex.
 */
enum { MP_RING_LINE = 8 };
struct mp_ring_line {
	uint64_t link[MP_RING_LINE]; /* as in struct mp_links: leaves for << 32 | comes from */
};

struct mp_ring_kernel {
	const char *name;
	/*
	 * Look at ${count} vertices, numbered ${low} and on, vertex low + i with links[i] links in
	 * line[i] (aligned to 64 bytes; what is behind them there may be anything).  False where
	 * one of them has 1 or 2 links, or up to MP_RING_LINE that are not one ring: steps from
	 * each to one that leaves for where it comes back from are home after all of them and no
	 * sooner.  True where there is none; label[i] is then the smallest vertex that is linked,
	 * or low + i if that is smaller.  More than MP_RING_LINE links are not judged.
	 */
	bool (*look)(const struct mp_ring_line *line, const uint8_t *links, uint32_t count,
		     uint32_t low, uint32_t *label);
};

/* The kernels that this machine can run, the plain one first, the best one last. */
size_t mp_ring_kernel_count(void);
const struct mp_ring_kernel *mp_ring_kernel_get(size_t i);

#endif
