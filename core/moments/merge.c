#include <math.h>
#include <string.h>

#include "core/moments/moments.h"

static const int AXES[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};

void mp_merge_begin(struct mp_merge *merge, const long double origin[3])
{
	memset(merge, 0, sizeof *merge);
	for (int k = 0; k < 3; k++)
		merge->origin[k] = origin[k];
}

/* What a part's moments are about: its centroid, or where it has none its reference. */
static struct mp_ball centre(const struct mp_solid *part, int k)
{
	if (!part->has_centroid)
		return mp_ball_exact(part->reference[k]);
	return mp_ball(part->centroid[k], part->centroid_bound[k]);
}

/* About ${r} from the origin: V r + F, V r r + F r + r F + S; F = 0 about the centroid. */
void mp_merge_add(struct mp_merge *merge, const struct mp_solid *part)
{
	struct mp_ball volume = mp_ball(part->volume, part->volume_bound), r[3], first[3];

	merge->volume = mp_ball_add(merge->volume, volume);
	for (int k = 0; k < 3; k++) {
		r[k] = mp_ball_sub(centre(part, k), mp_ball_exact(merge->origin[k]));
		first[k] = part->has_centroid ? mp_ball_exact(0) : part->first[k];
		merge->first[k] = mp_ball_add(merge->first[k], mp_ball_mul(volume, r[k]));
		merge->first[k] = mp_ball_add(merge->first[k], first[k]);
	}
	for (int k = 0; k < 6; k++) {
		int i = AXES[k][0], j = AXES[k][1];
		struct mp_ball square = mp_ball_mul(r[i], r[j]), second;

		if (part->has_centroid) {
			struct mp_ball cov = mp_ball(part->cov[k], part->cov_bound[k]);

			second = mp_ball_mul(volume, mp_ball_add(cov, square));
		} else {
			second = mp_ball_add(part->second[k], mp_ball_mul(volume, square));
			second = mp_ball_add(second, mp_ball_mul(first[i], r[j]));
			second = mp_ball_add(second, mp_ball_mul(r[i], first[j]));
		}
		merge->second[k] = mp_ball_add(merge->second[k], second);
	}
}

/* What is there where no volume is proven. */
static void solve_zero(const struct mp_merge *merge, struct mp_solid *io)
{
	io->volume = 0;
	io->volume_bound = mp_ball_most(merge->volume);
	for (int k = 0; k < 3; k++) {
		io->reference[k] = merge->origin[k];
		io->first[k] = merge->first[k];
	}
	for (int k = 0; k < 6; k++)
		io->second[k] = merge->second[k];
}

void mp_merge_solve(const struct mp_merge *merge, struct mp_solid *io)
{
	struct mp_ball g[3], x;

	memset(io->centroid, 0, sizeof io->centroid);
	memset(io->cov, 0, sizeof io->cov);
	io->has_centroid = mp_ball_not_zero(merge->volume);
	if (!io->has_centroid) {
		solve_zero(merge, io);
		return;
	}
	io->volume = merge->volume.mid;
	io->volume_bound = merge->volume.rad;
	for (int k = 0; k < 3; k++) {
		g[k] = mp_ball_div(merge->first[k], merge->volume);
		x = mp_ball_add(mp_ball_exact(merge->origin[k]), g[k]);
		io->centroid[k] = x.mid;
		io->centroid_bound[k] = x.rad;
	}
	for (int k = 0; k < 6; k++) {
		x = mp_ball_sub(mp_ball_div(merge->second[k], merge->volume),
				mp_ball_mul(g[AXES[k][0]], g[AXES[k][1]]));
		io->cov[k] = x.mid;
		io->cov_bound[k] = x.rad;
	}
}
