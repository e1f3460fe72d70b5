/* SPDX-License-Identifier: MIT */
#include "border/border.h"

#include <math.h>
#include <string.h>

#include "border/composite.h"
#include "common/cpu.h"
#include "common/mem.h"
#include "warp/functions.h"

enum {
    BAND = 16         /* how far beyond a strip pictures are compared, pixels of the gray picture */
};

/* The blend at the side of a frame takes 1/160 of the longer side, and 4 pixels at least. */
static const double seam_share = 1.0 / 160.0, least_seam_px = 4.0;
/* Strips reach this far inside, so that offsets can be measured; in seams. */
static const double strip_margin = 3.0;

/* All that one source needs. */
typedef struct Slot {
    L1L2WarpMesh mesh;
    L1L2BorderView view;
    L1L2BorderRegistration *registration;
    uint8_t *picture;
} Slot;

struct L1L2Border {
    L1L2BorderConfig cfg;
    L1L2BorderGrays grays;
    L1L2WarpMesh own_mesh;   /* of the affine map, where the frame's warp has no mesh */
    L1L2BorderView own_view;
    Slot slot[L1L2_BORDER_MAX_SOURCES];
    L1L2BorderSource source[L1L2_BORDER_MAX_SOURCES];
    L1L2BorderComposite composite;
    L1L2BorderMissing *missing;
};

/* Planes of a whole frame, one after the other. */
static uint8_t *picture_new(const L1L2BorderConfig *cfg, uint8_t *data[4], ptrdiff_t stride[4])
{
    const L1L2FormatInfo *format = cfg->format;
    size_t size = 0, from[L1L2_MAX_PLANES];
    for (int p = 0; p < format->planes; p++) {
        const int samples = l1l2_image_plane_size(cfg->width, format->plane[p].log2_sub_x);
        const int rows = l1l2_image_plane_size(cfg->height, format->plane[p].log2_sub_y);
        stride[p] = (ptrdiff_t)samples * format->plane[p].components * l1l2_image_format_bytes(format);
        from[p] = size;
        size += (size_t)stride[p] * (size_t)rows;
    }
    uint8_t *memory = l1l2_mem_new(size, 1);
    for (int p = 0; memory && p < format->planes; p++)
        data[p] = memory + from[p];
    return memory;
}

static bool source_init(L1L2Border *b, int index)
{
    Slot *slot = &b->slot[index];
    L1L2BorderSource *source = &b->source[index];
    const int columns = l1l2_border_nodes(b->grays.width), rows = l1l2_border_nodes(b->grays.height);
    const size_t nodes = (size_t)columns * (size_t)rows;
    source->mesh = &slot->mesh;
    source->field = (L1L2BorderField){columns, rows, l1l2_mem_new(nodes, sizeof(L1L2Point)),
                                      l1l2_mem_new(nodes, sizeof(float))};
    source->offset = l1l2_mem_new(nodes * L1L2_BORDER_COMPONENTS, sizeof(float));
    slot->registration = l1l2_border_registration_new(b->grays.width, b->grays.height);
    slot->picture = picture_new(&b->cfg, source->data, source->stride);
    return source->field.shift && source->field.agreement && source->offset && slot->registration && slot->picture &&
           l1l2_border_view_init(&slot->view, b->grays.width, b->grays.height) &&
           l1l2_warp_mesh_init(&slot->mesh, b->cfg.width, b->cfg.height);
}

static bool build(L1L2Border *b)
{
    const L1L2BorderConfig *cfg = &b->cfg;
    const int longer = cfg->width > cfg->height ? cfg->width : cfg->height;
    L1L2WarpFunctions functions;
    l1l2_warp_functions_init(&functions, l1l2_cpu_features());
    b->composite = (L1L2BorderComposite){
        .format = cfg->format,
        .chroma_site = cfg->chroma_site,
        .width = cfg->width,
        .height = cfg->height,
        .seam = fmax(longer * seam_share, least_seam_px),
        .generators = functions.generators,
        .pool = cfg->pool,
        .provider = l1l2_mem_new((size_t)cfg->width * (size_t)cfg->height, 1),
        .source = b->source,
    };
    if (!b->composite.provider || !l1l2_warp_mesh_init(&b->own_mesh, cfg->width, cfg->height))
        return false;
    if (cfg->reach == 0)
        return true;
    b->missing = l1l2_border_missing_new();
    if (!b->missing || !l1l2_border_grays_init(&b->grays, cfg->format, cfg->width, cfg->height, 2 * cfg->reach + 1) ||
        !l1l2_border_view_init(&b->own_view, b->grays.width, b->grays.height))
        return false;
    for (int i = 0; i < L1L2_BORDER_MAX_SOURCES; i++)
        if (!source_init(b, i))
            return false;
    return true;
}

L1L2Border *l1l2_border_new(const L1L2BorderConfig *cfg)
{
    L1L2Border *b = l1l2_mem_new(1, sizeof *b);
    if (!b)
        return NULL;
    b->cfg = *cfg;
    if (build(b))
        return b;
    l1l2_border_free(b);
    return NULL;
}

void l1l2_border_free(L1L2Border *b)
{
    if (!b)
        return;
    for (int i = 0; i < L1L2_BORDER_MAX_SOURCES; i++) {
        l1l2_warp_mesh_clear(&b->slot[i].mesh);
        l1l2_border_view_clear(&b->slot[i].view);
        l1l2_border_registration_free(b->slot[i].registration);
        l1l2_mem_free(b->slot[i].picture);
        l1l2_mem_free(b->source[i].field.shift);
        l1l2_mem_free(b->source[i].field.agreement);
        l1l2_mem_free(b->source[i].offset);
    }
    l1l2_border_missing_free(b->missing);
    l1l2_border_grays_clear(&b->grays);
    l1l2_border_view_clear(&b->own_view);
    l1l2_warp_mesh_clear(&b->own_mesh);
    l1l2_mem_free(b->composite.provider);
    l1l2_mem_free(b);
}

void l1l2_border_reset(L1L2Border *b)
{
    if (b->cfg.reach > 0)
        l1l2_border_grays_reset(&b->grays);
}

static int low_aligned(double at, int size)
{
    const int limited = (int)fmin(fmax(at, 0.0), size);
    return limited / L1L2_BORDER_ALIGN * L1L2_BORDER_ALIGN;
}

static int high_aligned(double at, int size)
{
    const int aligned = low_aligned(at, size) + L1L2_BORDER_ALIGN;
    return aligned < size ? aligned : size;
}

/* The rectangle outside of which some output may lie in the margin along the frame's sides, or beyond them. A node
 * there takes the cells around it with it. */
static L1L2WarpRect inner_part(const L1L2WarpMesh *mesh, double margin)
{
    const int width = mesh->width, height = mesh->height;
    const double half_w = 0.5 * width - margin, half_h = 0.5 * height - margin;
    const double cell_w = (double)width / (mesh->columns - 1), cell_h = (double)height / (mesh->rows - 1);
    double left = 0.0, right = width, top = 0.0, bottom = height;
    for (int row = 0; row < mesh->rows; row++)
        for (int column = 0; column < mesh->columns; column++) {
            const L1L2Point at = mesh->node[row * mesh->columns + column];
            if (at.x < -half_w)
                left = fmax(left, (column + 1) * cell_w);
            if (at.x > half_w)
                right = fmin(right, (column - 1) * cell_w);
            if (at.y < -half_h)
                top = fmax(top, (row + 1) * cell_h);
            if (at.y > half_h)
                bottom = fmin(bottom, (row - 1) * cell_h);
        }
    if (left >= right || top >= bottom)
        return (L1L2WarpRect){0, 0, 0, 0};
    const L1L2WarpRect inner = {left > 0.0 ? high_aligned(left, width) : 0, top > 0.0 ? high_aligned(top, height) : 0,
                                right < width ? low_aligned(right, width) : width,
                                bottom < height ? low_aligned(bottom, height) : height};
    return inner.left < inner.right && inner.top < inner.bottom ? inner : (L1L2WarpRect){0, 0, 0, 0};
}

/* What is outside the inner part, as rectangles that do not overlap. */
static L1L2WarpParts lay_strips(const L1L2WarpRect *inner, int width, int height)
{
    return (L1L2WarpParts){L1L2_BORDER_STRIPS, {
        {0, 0, width, inner->top},
        {0, inner->bottom, width, height},
        {0, inner->top, inner->left, inner->bottom},
        {inner->right, inner->top, width, inner->bottom},
    }};
}

/* The parts of the gray picture that tell where the strips have to be taken from. */
static L1L2BorderBand band_around(const L1L2Border *b, const L1L2WarpParts *strips)
{
    const int width = b->grays.width, height = b->grays.height;
    const double to_x = (double)width / b->cfg.width, to_y = (double)height / b->cfg.height;
    L1L2BorderBand band = {.count = 0};
    for (int k = 0; k < L1L2_BORDER_STRIPS; k++) {
        const L1L2WarpRect *strip = &strips->rect[k];
        if (l1l2_border_is_empty(strip))
            continue;
        const int left = (int)(strip->left * to_x) - BAND, top = (int)(strip->top * to_y) - BAND;
        const int right = (int)(strip->right * to_x) + BAND, bottom = (int)(strip->bottom * to_y) + BAND;
        band.rect[band.count++] = (L1L2WarpRect){left > 0 ? left : 0, top > 0 ? top : 0, right < width ? right : width,
                                                 bottom < height ? bottom : height};
    }
    return band;
}

typedef struct RegistrationJob {
    L1L2Border *border;
    const L1L2BorderJob *job;
    const L1L2BorderNeighbor *neighbor[L1L2_BORDER_MAX_SOURCES];
    const L1L2BorderGray *gray[L1L2_BORDER_MAX_SOURCES];
    bool comparable[L1L2_BORDER_MAX_SOURCES];
} RegistrationJob;

/* The mesh of a map after a displacement. to_x, to_y: output pixels of a gray pixel. */
static void set_displaced(L1L2WarpMesh *mesh, const L1L2Mat *map, const L1L2BorderField *field, double to_x,
                          double to_y)
{
    const bool affine = l1l2_mat_is_affine(map);
    for (int row = 0; row < mesh->rows; row++)
        for (int column = 0; column < mesh->columns; column++) {
            const double u = (double)column / (mesh->columns - 1) * (field->columns - 1);
            const double v = (double)row / (mesh->rows - 1) * (field->rows - 1);
            const int left = u >= field->columns - 1 ? field->columns - 2 : (int)u;
            const int top = v >= field->rows - 1 ? field->rows - 2 : (int)v;
            const double x = u - left, y = v - top;
            const L1L2Point *a = field->shift + top * field->columns + left, *c = a + field->columns;
            const double above_x = a[0].x + x * (a[1].x - a[0].x), below_x = c[0].x + x * (c[1].x - c[0].x);
            const double above_y = a[0].y + x * (a[1].y - a[0].y), below_y = c[0].y + x * (c[1].y - c[0].y);
            L1L2Point at = l1l2_warp_mesh_position(mesh, column, row);
            at.x += (above_x + y * (below_x - above_x)) * to_x;
            at.y += (above_y + y * (below_y - above_y)) * to_y;
            mesh->node[row * mesh->columns + column] =
                affine ? l1l2_mat_apply_affine(map, at) : l1l2_mat_apply(map, at);
        }
}

/* index: of a source. */
static void register_source(void *context, int index)
{
    const RegistrationJob *job = context;
    L1L2Border *b = job->border;
    Slot *slot = &b->slot[index];
    L1L2BorderField *field = &b->source[index].field;
    const L1L2Mat map = l1l2_mat_mul(job->neighbor[index]->map, job->job->own->affine);
    l1l2_warp_mesh_set(&slot->mesh, &map);
    if (!job->comparable[index]) {
        for (int i = 0; i < field->columns * field->rows; i++) {
            field->shift[i] = (L1L2Point){0.0, 0.0};
            field->agreement[i] = 1.0f;
        }
        return;
    }
    const L1L2BorderBand band = band_around(b, &b->source[index].part);
    l1l2_border_view(&slot->view, job->gray[index], &slot->mesh, &band);
    l1l2_border_register(slot->registration, &b->own_view, &slot->view, &band, field);
    set_displaced(&slot->mesh, &map, field, (double)b->cfg.width / b->grays.width,
                  (double)b->cfg.height / b->grays.height);
}

static const L1L2BorderGray *gray_of(L1L2Border *b, int64_t t, const uint8_t *const *data, const ptrdiff_t *stride)
{
    return l1l2_border_gray_of(&b->grays, t, data[0], stride[0]);
}

/* Steps 2 to 4. */
static void render_sources(L1L2Border *b, const L1L2BorderJob *job, const L1L2WarpMesh *own)
{
    L1L2BorderComposite *c = &b->composite;
    const L1L2BorderNeed need = {job->t, &job->own->affine, b->cfg.width, b->cfg.height, c->strips};
    const L1L2BorderChoice choice = l1l2_border_choose(b->missing, &need, job->neighbors, job->count);
    c->sources = choice.count;
    if (choice.count == 0)
        return;
    RegistrationJob registration = {.border = b, .job = job};
    const L1L2BorderBand band = band_around(b, &c->strips);
    const L1L2BorderGray *gray = gray_of(b, job->t, job->src, job->src_stride);
    for (int i = 0; i < choice.count; i++) {
        const L1L2BorderNeighbor *neighbor = &job->neighbors[choice.neighbor[i]];
        b->source[i].distance = (int)(neighbor->t - job->t);
        b->source[i].part = choice.part[i];
        registration.neighbor[i] = neighbor;
        registration.gray[i] = gray_of(b, neighbor->t, neighbor->data, neighbor->stride);
        registration.comparable[i] = l1l2_image_levels_equal(gray->levels, registration.gray[i]->levels);
    }
    l1l2_border_view(&b->own_view, gray, own, &band);
    l1l2_pool_run(b->cfg.pool, choice.count, register_source, &registration);
    for (int i = 0; i < choice.count; i++) {
        const L1L2WarpMap map = {.mesh = b->source[i].mesh, .affine = l1l2_mat_identity()};
        l1l2_warp_render_parts(b->cfg.warp, &map, &choice.part[i], registration.neighbor[i]->data,
                               registration.neighbor[i]->stride, b->source[i].data, b->source[i].stride);
    }
}

static L1L2BorderShares count_shares(const L1L2BorderComposite *c)
{
    int64_t filled = 0, extended = 0;
    for (int k = 0; k < L1L2_BORDER_STRIPS; k++)
        for (int y = c->strips.rect[k].top; y < c->strips.rect[k].bottom; y++)
            for (int x = c->strips.rect[k].left; x < c->strips.rect[k].right; x++) {
                const int provider = c->provider[y * c->width + x];
                extended += provider == L1L2_BORDER_EXTENDED;
                filled += provider != L1L2_BORDER_EXTENDED && provider != L1L2_BORDER_OWN;
            }
    const double all = (double)c->width * c->height;
    return (L1L2BorderShares){(double)filled / all, (double)extended / all};
}

L1L2BorderShares l1l2_border_render(L1L2Border *b, const L1L2BorderJob *job)
{
    L1L2BorderComposite *c = &b->composite;
    const L1L2WarpMesh *own = job->own->mesh;
    if (!own) {
        l1l2_warp_mesh_set(&b->own_mesh, &job->own->affine);
        own = &b->own_mesh;
    }
    l1l2_warp_render(b->cfg.warp, job->own, job->src, job->src_stride, job->dst, job->dst_stride);
    memset(c->provider, L1L2_BORDER_OWN, (size_t)c->width * (size_t)c->height);
    const L1L2WarpRect shown = inner_part(own, 0.0);
    if (shown.right - shown.left == c->width && shown.bottom - shown.top == c->height)
        return (L1L2BorderShares){0.0, 0.0};
    const L1L2WarpRect inner = inner_part(own, strip_margin * c->seam);
    c->strips = lay_strips(&inner, c->width, c->height);
    c->own = *job->own;
    c->src = job->src;
    c->src_stride = job->src_stride;
    c->dst = job->dst;
    c->dst_stride = job->dst_stride;
    c->sources = 0;
    if (b->cfg.reach > 0)
        render_sources(b, job, own);
    l1l2_border_composite(c);
    return count_shares(c);
}

const uint8_t *l1l2_border_providers(const L1L2Border *b)
{
    return b->composite.provider;
}
