"""All campaigns, in the order of the table."""

from torture.campaign import Campaign
from torture.campaigns import models, planted, records

CAMPAIGNS: dict[str, Campaign] = {
    campaign.name: campaign for campaign in (planted.CAMPAIGN, models.CAMPAIGN, records.CAMPAIGN)
}
