"""All campaigns, in the order of the table."""

from torture.campaign import Campaign
from torture.campaigns import (
    arms,
    calls,
    files,
    limits,
    models,
    options,
    planted,
    records,
    signals,
    surroundings,
)

CAMPAIGNS: dict[str, Campaign] = {
    campaign.name: campaign
    for campaign in (
        planted.CAMPAIGN,
        models.CAMPAIGN,
        records.CAMPAIGN,
        files.CAMPAIGN,
        calls.CAMPAIGN,
        options.CAMPAIGN,
        limits.CAMPAIGN,
        arms.CAMPAIGN,
        signals.KILLS,
        signals.INTERRUPTS,
        surroundings.CAMPAIGN,
    )
}
